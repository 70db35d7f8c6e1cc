#pragma once

#include <filesystem>
#include <luminav/camera_image_t.hpp>
#include <opencv2/core.hpp>

#include "services/detector/detector.hpp"

namespace luminav {

/// Looks at a drive's pictures with the paper's chain and keeps the one in which most fixtures were validated.
class DetectionPicture {
 public:
  /// Throws ConfigurationError.
  DetectionPicture(const std::filesystem::path& robot_file, const std::filesystem::path& building_file);

  /// Takes mono8 pictures only.
  void look_at(const camera_image_t& image);
  /// Contours red, rectangles green, validated poses blue. Throws std::runtime_error if nothing was ever seen, or the
  /// file cannot be written.
  void write(const std::filesystem::path& png_file) const;

 private:
  Detector detector_;
  std::size_t max_ = 0;
  cv::Mat picture_;
};

}  // namespace luminav
