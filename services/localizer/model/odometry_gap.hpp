#pragma once

#include <Eigen/Core>
#include <string>

#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// What a robot did whose odometry cannot be joined to what came before.
struct OdometryGap {
  Pose2 step;                     // mean motion across the gap
  Eigen::Matrix3d noise;          // covariance of (x, y, theta) in the frame at its beginning
  bool may_be_kidnapped = false;  // long enough to take the robot elsewhere
};

/// A robot that is heard no more may have been stopped at once or drives on with its last twist until its own watchdog
/// stops it, two seconds later; somebody may have pushed it a little. `last` and `next` are the readings on both sides;
/// no longer than the time between them is it assumed to have driven.
OdometryGap odometry_gap(const OdometryReading& last, const OdometryReading& next);

/// Motion from the newest reading to an image's time [us] that odometry has not reached yet: with the last twist, known
/// as well as a robot can change it.
[[nodiscard]] OdometryGap extrapolate(const OdometryReading& newest, std::int64_t utime);

/// Why motion between two readings is not known; empty when it is.
[[nodiscard]] std::string find_gap(const OdometryReading& last, const OdometryReading& next);

}  // namespace luminav
