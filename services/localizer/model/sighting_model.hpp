#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/model/pose_kalman.hpp"

namespace luminav {

/// Where a fixture appears in the robot frame, and how that changes with the robot's pose.
struct ExpectedSighting {
  Pose2 robot_from_fixture;
  Eigen::Matrix3d jacobian =
      Eigen::Matrix3d::Zero();  // d(x, y, theta in robot frame) / d(x, y, theta of the robot in the world)
};

/// The fixture at `world_from_fixture` as the robot at `world_from_robot` would see it.
ExpectedSighting expect_sighting(const Pose2& world_from_robot, const Pose2& world_from_fixture);

/// Difference sighting - expectation; the angle modulo the fixture's symmetry, 0 where it has no orientation.
Eigen::Vector3d sighting_residual(const FixtureSighting& sighting, const Pose2& expected, FixtureShape shape);

/// Comparison of a sighting with a fixture.
struct Innovation {
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // of the residual
  double nis = 0.0;                                          // squared Mahalanobis length of the residual
  double log_volume = 0.0;                                   // half the log of det(covariance) / det(noise)
};

/// A sighting taken as a fixture of the building.
struct FixtureMatch {
  std::size_t sighting = 0;
  int fixture = 0;
  double nis = 0.0;
  double log_likelihood = 0.0;
};

/// Leaves one match for each sighting and fixture, the best first: fixtures stand so far apart that a better sum of
/// worse matches does not occur.
void keep_best(std::vector<FixtureMatch>& matches);

/// Innovation of a belief; `noise` is the sighting's whole covariance, as of white_sighting_covariance.
Innovation innovate(const PoseBelief& belief, const FixtureSighting& sighting, const Fixture& fixture,
                    const Eigen::Matrix3d& noise);

/// Kalman correction with a noise that may be larger than the one the innovation was gated with.
void correct(PoseBelief& belief, const Innovation& innovation, const Eigen::Matrix3d& noise);

}  // namespace luminav
