#pragma once

#include <Eigen/Core>

#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/common/geometry/angle.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// 1-sigma of what is wrong with robot, camera and building and does not average away. The defaults are those of a
/// robot that nobody calibrated.
struct ErrorParams {
  double odometry_position = 0.01;          // [m per sqrt m] white
  double odometry_heading = radians(0.5);   // [rad per sqrt m] white
  double wheel_scale = 0.01;                // fraction, constant
  double wheel_ratio = 0.005;               // fraction, constant: one wheel larger than the other
  double wheel_base = 0.01;                 // fraction, constant
  double camera_tilt = radians(0.5);        // [rad] per axis, constant
  double camera_yaw = radians(0.5);         // [rad] constant
  double camera_scale = 0.007;              // fraction, constant: heights of camera and ceiling
  double camera_time_offset = 0.020;        // [s] constant
  double lens_residual = 0.01;              // k1 left over, constant
  double fixture_position = 0.010;          // [m] per axis, constant per fixture
  double fixture_heading = radians(0.5);    // [rad] constant per fixture
  double floor_tilt = radians(0.1);         // [rad] per axis, changes from metre to metre
  double sighting_position = 0.003;         // [m] least white noise of a sighting, whatever the detector says
  double sighting_heading = radians(0.15);  // [rad] likewise
};

/// Length of way [m] that counts for odometry's noise: the wheels also travel when the robot turns on the spot.
double noise_distance(const Pose2& delta, double wheel_base);

/// White noise of an odometry step in the frame at its beginning: covariance of (x, y, theta).
Eigen::Matrix3d odometry_noise(const Pose2& delta, double wheel_base, const ErrorParams& params);

/// What a small filter without error states adds on top for errors that are constant: grows with the square of the
/// step's share in `memory` [m], so that it is right for gaps of about that length.
Eigen::Matrix3d odometry_noise_with_systematics(const Pose2& delta, double wheel_base, const ErrorParams& params);

/// A variance that says "not measured" [rad^2].
inline constexpr double kNoAngle = 1e4;

/// White part of a sighting's covariance, robot frame: the detector's own, with a floor, and what a half-lit
/// fixture leaves open. The angle of one that shows none has kNoAngle.
Eigen::Matrix3d white_sighting_covariance(const FixtureSighting& sighting, const Fixture& fixture,
                                          const ErrorParams& params);

/// What a correction takes for white noise besides, robot frame: all images of a pass may show the same stretch of a
/// fixture, and their mean knows no better than one of them where along the fixture it lies.
Eigen::Matrix3d covariance_shared_by_pass(const FixtureSighting& sighting, const Fixture& fixture);

/// The constant part, robot frame: tilt, yaw, scale, lens, time offset and the fixture's own error; twist in the robot
/// frame.
Eigen::Matrix3d systematic_sighting_covariance(const FixtureSighting& sighting, double height_above_camera,
                                               double linear, double angular, const ErrorParams& params);

}  // namespace luminav
