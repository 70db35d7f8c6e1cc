#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// A thing on the ceiling as one image showed it.
struct CeilingLook {
  std::int64_t utime = 0;  // [us]
  Pose2 odom_from_robot;
  Pose2 robot_from_thing;
  Eigen::Matrix2d covariance;  // [m^2] of its place, robot frame
};

/// No motion of the wheels between two looks at one thing, with full, half or no grip of each, explains where it is now
/// to `max` [m] beyond image noise. `wheel_base` [m]
[[nodiscard]] bool is_beyond_slip(const CeilingLook& before, const CeilingLook& now, double wheel_base, double max);

}  // namespace luminav
