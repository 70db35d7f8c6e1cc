#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/localizer/integrity/slipping_wheels.hpp"

namespace luminav {

/// Detects things on the ceiling that pass faster than the wheels turn: then somebody carries the robot. Things are
/// associated from image to image by distance alone, since three images may be all that show one.
class MotionOutlier {
 public:
  /// `wheel_base` [m]
  explicit MotionOutlier(double wheel_base) : wheel_base_(wheel_base) {}

  /// One image. True if a thing in view went by even steps, in each of the last two 0.4 m/s faster than what
  /// wheels, slipping or not, and noise explain, and no other that was seen as long did not.
  [[nodiscard]] bool look(const SightingFrame& frame, const Pose2& odom_from_robot);
  /// Relative motion across now is unknown.
  void clear() { now_.clear(); }

 private:
  struct Thing {
    CeilingLook look;
    std::optional<Eigen::Vector2d> step;  // [m] from the image before, beside what the wheels say, robot frame
    bool is_fast = false;                 // that step
  };
  [[nodiscard]] const Thing* find_before(const CeilingLook& now) const;

  double wheel_base_;          // [m]
  std::vector<Thing> before_;  // of the image before
  std::vector<Thing> now_;     // of the newest image
};

}  // namespace luminav
