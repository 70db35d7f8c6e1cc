#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "services/detector/model/detection.hpp"

namespace luminav {

/// Notices when the lamps keep looking longer or shorter than the building's file says: a wrong ceiling height or size
/// is still within what the detector accepts, and bends every place that follows from it.
class SizeWatch {
 public:
  /// What one frame shows; only what is whole in view counts.
  void add(std::span<const Detection> detections);
  /// A sentence for the user; "" while the sizes are right, few or do not agree.
  [[nodiscard]] std::string complaint() const;

 private:
  static constexpr std::size_t kCount = 60;
  std::array<double, kCount> scales_{};  // seen length / nominal length, the last ones
  std::size_t next_ = 0;
  std::size_t seen_ = 0;
};

}  // namespace luminav
