#include "services/localizer/sighting_model.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace luminav {

ExpectedSighting expect_sighting(const Pose2& world_from_robot, const Pose2& world_from_fixture) {
  ExpectedSighting expected;
  const double c = std::cos(world_from_robot.theta);
  const double s = std::sin(world_from_robot.theta);
  const double dx = world_from_fixture.x - world_from_robot.x;
  const double dy = world_from_fixture.y - world_from_robot.y;
  expected.robot_from_fixture = {c * dx + s * dy, -s * dx + c * dy,
                                 wrap_angle(world_from_fixture.theta - world_from_robot.theta)};
  expected.jacobian << -c, -s, expected.robot_from_fixture.y,  //
      s, -c, -expected.robot_from_fixture.x,                   //
      0.0, 0.0, -1.0;
  return expected;
}

Eigen::Vector3d sighting_residual(const FixtureSighting& sighting, const Pose2& expected, FixtureShape shape) {
  const double period = sighting.has_theta ? symmetry_period(shape) : 0.0;
  return {sighting.robot_from_fixture.x - expected.x, sighting.robot_from_fixture.y - expected.y,
          wrap_modulo(sighting.robot_from_fixture.theta - expected.theta, period)};
}

Innovation innovate(const PoseBelief& belief, const FixtureSighting& sighting, const Fixture& fixture,
                    Eigen::Matrix3d noise) {
  if (!sighting.has_theta || symmetry_period(fixture.shape) == 0.0) {
    noise(2, 2) += kNoAngle;
  }
  const ExpectedSighting expected = expect_sighting(belief.pose, fixture.world_from_fixture);
  Innovation innovation;
  innovation.residual = sighting_residual(sighting, expected.robot_from_fixture, fixture.shape);
  innovation.jacobian = expected.jacobian;
  innovation.covariance = expected.jacobian * belief.covariance * expected.jacobian.transpose() + noise;
  const Eigen::Matrix3d inverse = innovation.covariance.inverse();
  innovation.nis = innovation.residual.dot(inverse * innovation.residual);
  innovation.log_volume = 0.5 * std::log(std::max(1.0, innovation.covariance.determinant() / noise.determinant()));
  return innovation;
}

void correct(PoseBelief& belief, const Innovation& innovation, const Eigen::Matrix3d& noise) {
  const Eigen::Matrix3d& h = innovation.jacobian;
  const Eigen::Matrix3d cross = belief.covariance * h.transpose();
  const Eigen::Matrix3d inverse = Eigen::Matrix3d(h * cross + noise).inverse();
  const Eigen::Matrix3d gain = cross * inverse;
  const Eigen::Vector3d step = gain * innovation.residual;
  belief.pose.x += step.x();
  belief.pose.y += step.y();
  belief.pose.theta = wrap_angle(belief.pose.theta + step.z());
  const Eigen::Matrix3d remaining = Eigen::Matrix3d::Identity() - gain * h;
  const Eigen::Matrix3d updated =
      remaining * belief.covariance * remaining.transpose() + gain * noise * gain.transpose();
  belief.covariance = 0.5 * (updated + updated.transpose());
}

void predict(PoseBelief& belief, const Pose2& delta, const Eigen::Matrix3d& noise) {
  const double c = std::cos(belief.pose.theta);
  const double s = std::sin(belief.pose.theta);
  const Pose2 moved = belief.pose * delta;
  Eigen::Matrix3d transition = Eigen::Matrix3d::Identity();
  transition(0, 2) = -(moved.y - belief.pose.y);
  transition(1, 2) = moved.x - belief.pose.x;
  Eigen::Matrix3d rotation;
  rotation << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  belief.covariance = Eigen::Matrix3d(transition * belief.covariance * transition.transpose() +
                                      rotation * noise * rotation.transpose());
  belief.pose = moved;
}

}  // namespace luminav
