#include "services/localizer/model/error_model.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

double squared(double value) {
  return value * value;
}

/// Variance along a fixture of a stretch of it, which lies anywhere there; 0 where an end is seen. [m^2]
double variance_of_stretch(const FixtureSighting& sighting, const Fixture& fixture) {
  const bool is_stretch = sighting.clipped && !sighting.near_end_visible && !sighting.far_end_visible;
  return is_stretch ? squared(std::max(0.0, fixture.length - sighting.length)) / 12.0 : 0.0;
}

Eigen::Matrix3d variance_in_direction(double theta, double variance) {
  const Eigen::Vector3d direction(std::cos(theta), std::sin(theta), 0.0);
  return variance * direction * direction.transpose();
}

}  // namespace

double noise_distance(const Pose2& delta, double wheel_base) {
  return std::sqrt(squared(delta.x) + squared(delta.y)) + 0.5 * wheel_base * std::abs(delta.theta);
}

Eigen::Matrix3d odometry_noise(const Pose2& delta, double wheel_base, const ErrorParams& params) {
  const double distance = noise_distance(delta, wheel_base);
  const double position = squared(params.odometry_position) * distance;
  const double heading = squared(params.odometry_heading) * distance;
  // the heading's error grows along the step, so half of it acts on the position across
  const double x = -0.5 * delta.y;
  const double y = 0.5 * delta.x;
  Eigen::Matrix3d noise;
  noise << position + heading * x * x, heading * x * y, heading * x,  //
      heading * x * y, position + heading * y * y, heading * y,       //
      heading * x, heading * y, heading;
  return noise;
}

Eigen::Matrix3d odometry_noise_with_systematics(const Pose2& delta, double wheel_base, const ErrorParams& params) {
  // A constant error e per metre gives e * d after d metres; as white noise e^2 * kGap * d it is right at d = kGap.
  constexpr double kGap = 3.0;            // [m] between fixtures
  constexpr double kTurnGap = 0.5 * kPi;  // [rad]
  const double distance = std::hypot(delta.x, delta.y);
  const double turn = std::abs(delta.theta);
  const double scale = squared(params.wheel_scale) * kGap * distance;
  const double drift = squared(params.wheel_ratio / wheel_base) * kGap * distance +
                       (squared(params.wheel_base) + squared(params.wheel_scale)) * kTurnGap * turn;
  Eigen::Matrix3d noise = odometry_noise(delta, wheel_base, params);
  noise(0, 0) += scale;
  noise(1, 1) += 0.25 * scale;
  noise(2, 2) += drift;
  return noise;
}

Eigen::Matrix3d white_sighting_covariance(const FixtureSighting& sighting, const Fixture& fixture,
                                          const ErrorParams& params) {
  const double theta = sighting.robot_from_fixture.theta;
  Eigen::Matrix3d covariance = sighting.covariance;
  covariance(0, 0) += squared(params.sighting_position);
  covariance(1, 1) += squared(params.sighting_position);
  covariance(2, 2) += squared(params.sighting_heading);
  if (!sighting.has_theta || symmetry_period(fixture.shape) == 0.0) {
    covariance(2, 2) += kNoAngle;
  }
  if (sighting.state == SightingState::kHalf) {
    covariance += variance_in_direction(theta + 0.5 * kPi, squared(0.25 * std::max(fixture.width, sighting.width)));
  }
  // the detector may have thought of a shorter kind
  const Eigen::Vector3d along(std::cos(theta), std::sin(theta), 0.0);
  const double reported = along.dot(sighting.covariance * along);
  return covariance + variance_in_direction(theta, std::max(0.0, variance_of_stretch(sighting, fixture) - reported));
}

Eigen::Matrix3d covariance_shared_by_pass(const FixtureSighting& sighting, const Fixture& fixture) {
  constexpr double kImages = 30.0;
  return variance_in_direction(sighting.robot_from_fixture.theta,
                               (kImages - 1.0) * variance_of_stretch(sighting, fixture));
}

Eigen::Matrix3d systematic_sighting_covariance(const FixtureSighting& sighting, double height_above_camera,
                                               double linear, double angular, const ErrorParams& params) {
  const Eigen::Vector2d place = sighting.robot_from_fixture.position();
  const double isotropic = squared(height_above_camera * params.camera_tilt) +
                           squared(height_above_camera * params.floor_tilt) + squared(params.fixture_position);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  covariance(0, 0) = covariance(1, 1) = isotropic;
  covariance(2, 2) = squared(params.fixture_heading);
  const Eigen::Vector3d by_yaw(-place.y(), place.x(), 1.0);
  covariance += squared(params.camera_yaw) * by_yaw * by_yaw.transpose();
  const Eigen::Vector3d by_scale(place.x(), place.y(), 0.0);
  covariance += squared(params.camera_scale) * by_scale * by_scale.transpose();
  const Eigen::Vector2d ray = place / height_above_camera;
  const Eigen::Vector3d by_lens(place.x() * ray.squaredNorm(), place.y() * ray.squaredNorm(), ray.squaredNorm());
  covariance += squared(params.lens_residual) * by_lens * by_lens.transpose();
  // what stands still in the world moves so in the robot frame
  const Eigen::Vector3d by_time(-linear + angular * place.y(), -angular * place.x(), -angular);
  covariance += squared(params.camera_time_offset) * by_time * by_time.transpose();
  return covariance;
}

}  // namespace luminav
