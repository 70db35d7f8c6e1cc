#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// Detects by sonar that a robot is carried while its wheels stand still: then everything it hears moves, on all sides.
/// People who pass move a few echoes at a time.
class SonarChange {
 public:
  /// True if most discs hear things elsewhere than when the wheels stopped, or some seconds ago. Then it starts again.
  [[nodiscard]] bool look(const SonarScan& scan, const Pose2& odom_from_robot);

 private:
  /// What a disc heard first and last.
  struct Disc {
    std::optional<SonarEcho> first;
    std::optional<SonarEcho> last;
  };

  void begin(std::int64_t utime);
  [[nodiscard]] bool has_moved() const;

  Pose2 odom_from_robot_;
  int still_scans_ = 0;     // in a row without wheel motion
  std::int64_t begun_ = 0;  // [us]
  std::vector<Disc> discs_;
};

}  // namespace luminav
