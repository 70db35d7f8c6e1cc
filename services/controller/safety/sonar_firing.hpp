#pragma once

#include <cmath>
#include <cstdint>

#include "services/common/configuration/robot_file.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// One firing of one disc.
struct SonarFiring {
  std::size_t disc = 0;
  std::int64_t utime = 0;  // [us]
  double range = 0.0;      // [m]
  bool has_echo = false;
  Pose2 odom_from_robot;  // when it fired
};

/// Tells whether two firings of a disc heard the same range. An echo has noise of its own: what differs by 5 mm or less
/// has not changed.
inline bool hear_the_same(const SonarFiring& a, const SonarFiring& b) {
  return a.has_echo && b.has_echo && std::abs(a.range - b.range) <= 0.005;
}

/// Distance [m] the robot moved along the axis of the disc from one of its firings to a later one, ahead or back: by it
/// the disc's range has to change.
inline double moved_along_axis(const SonarRing& ring, const SonarFiring& from, const SonarFiring& to) {
  const double axis = from.odom_from_robot.theta + ring.robot_from_sonar[from.disc].theta;
  const Eigen::Vector2d moved = to.odom_from_robot.position() - from.odom_from_robot.position();
  return std::abs(moved.x() * std::cos(axis) + moved.y() * std::sin(axis));
}

}  // namespace luminav
