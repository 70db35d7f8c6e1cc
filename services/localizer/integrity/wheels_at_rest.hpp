#pragma once

#include <cmath>

#include "services/common/geometry/angle.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// The wheels did not turn between two readings of odometry a tenth of a second or less apart.
[[nodiscard]] inline bool are_wheels_at_rest(const Pose2& odom_from_before, const Pose2& odom_from_now) {
  const Pose2 step = odom_from_before.inverse() * odom_from_now;
  return std::hypot(step.x, step.y) < 0.001 && std::abs(step.theta) < radians(0.1);
}

}  // namespace luminav
