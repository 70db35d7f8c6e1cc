#pragma once

#include <cstdint>
#include <filesystem>
#include <luminav/camera_image_t.hpp>
#include <optional>
#include <string>
#include <utility>

#include "services/common/geometry/pose2.hpp"
#include "services/jobs/job.hpp"

namespace luminav {

/// Pictures of the robot's camera at stops of tours, as they were received: STAMP-JOB-STOP.jpg (.pgm of a camera in the
/// same program) in a folder, and beside each what is known of it, as JSON. The last 100 are kept.
class PhotoStore {
 public:
  static constexpr std::size_t kMaxPhotos = 100;

  /// "" = keeps nothing.
  explicit PhotoStore(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Throws std::runtime_error when it cannot be written.
  void keep(const camera_image_t& image, const PhotoWish& wish, const std::optional<Pose2>& world_from_robot) const;

 private:
  void forget_oldest() const;

  std::filesystem::path folder_;
};

}  // namespace luminav
