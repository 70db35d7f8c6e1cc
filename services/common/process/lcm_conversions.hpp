#pragma once

#include <algorithm>
#include <cmath>
#include <luminav/odometry_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

inline Pose2 odom_from_robot(const odometry_t& message) {
  return {message.x, message.y, message.theta};
}
inline Pose2 world_from_robot(const pose_t& message) {
  return {message.x, message.y, message.theta};
}

/// Square root of the mean position variance [m].
inline double position_sigma(const pose_t& message) {
  return std::sqrt(std::max(0.0, 0.5 * (message.covariance[0] + message.covariance[4])));
}

/// False for values that are not finite, places beyond 100 km, and speeds beyond 10 m/s or 100 rad/s. Sums and grid
/// cells of anything smaller do not overflow.
[[nodiscard]] bool is_possible(const odometry_t& message);
[[nodiscard]] bool is_possible(const pose_t& message);

/// Something blocks a wheel or presses a bumper.
inline bool is_blocked(const robot_status_t& message) {
  return message.stall_left || message.stall_right || message.bumpers_front != 0 || message.bumpers_rear != 0;
}

}  // namespace luminav
