#include "services/localizer/model/sighting_model.hpp"

#include <Eigen/Dense>
#include <algorithm>
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

void keep_best(std::vector<FixtureMatch>& matches) {
  std::stable_sort(matches.begin(), matches.end(),
                   [](const FixtureMatch& a, const FixtureMatch& b) { return a.nis < b.nis; });
  auto end = matches.begin();
  for (const FixtureMatch& match : matches) {
    if (std::none_of(matches.begin(), end, [&](const FixtureMatch& better) {
          return better.sighting == match.sighting || better.fixture == match.fixture;
        })) {
      *end++ = match;
    }
  }
  matches.erase(end, matches.end());
}

Innovation innovate(const PoseBelief& belief, const FixtureSighting& sighting, const Fixture& fixture,
                    const Eigen::Matrix3d& noise) {
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
  const Eigen::Matrix3d pose_by_sighting = innovation.jacobian.inverse();
  fuse_pose(belief, pose_by_sighting * innovation.residual, pose_by_sighting * noise * pose_by_sighting.transpose());
}

}  // namespace luminav
