#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

enum class SightingState { kUnknown, kLit, kUnlit, kHalf };

/// One fixture seen in one image. Pose in the robot frame at the image's time.
struct FixtureSighting {
  Pose2 robot_from_fixture;                                  // centre; theta along the long side, modulo its symmetry
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // [m^2, m rad, rad^2] pixel noise only
  FixtureShape shape = FixtureShape::kRectangle;
  SightingState state = SightingState::kUnknown;
  bool has_theta = true;
  double length = 0.0;           // [m] as seen; of a clipped one the visible part
  double width = 0.0;            // [m]
  bool clipped = false;          // the image border cuts it
  bool near_end_visible = true;  // the end towards -theta
  bool far_end_visible = true;   // the end towards +theta
  double fit = 1.0;              // 0..1
};

/// All that one image showed; also sent when nothing was seen.
struct SightingFrame {
  std::int64_t utime = 0;  // [us] of the image, the camera's time offset already added
  std::vector<FixtureSighting> sightings;
  bool shows_unlit = true;  // false: taken for the lamps, too dark for what does not burn
  double exposure = 0.0;    // [s]
};

/// Wheel odometry at one instant.
struct OdometryReading {
  std::int64_t utime = 0;    // [us]
  std::int64_t session = 0;  // a new value: relative motion across it is unknown
  Pose2 odom_from_robot;
  double linear = 0.0;   // [m/s]
  double angular = 0.0;  // [rad/s]
};

/// One sonar reading; `disc` indexes the robot's ring.
struct SonarEcho {
  int disc = 0;
  double range = 0.0;  // [m]
  bool has_echo = false;
  std::int64_t utime = 0;  // [us] when it was taken
};

struct SonarScan {
  std::int64_t utime = 0;           // [us] of the newest reading
  std::vector<SonarEcho> readings;  // the fresh ones only
};

}  // namespace luminav
