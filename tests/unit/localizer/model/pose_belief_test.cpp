#include "services/localizer/model/pose_belief.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace luminav {
namespace {

TEST(RoundPositionSigma, IsOfTheRoundErrorOfWhich95PercentLieWithinTheSameRadius) {
  constexpr double kRadii = 2.448;  // sigmas of a round error within which 95 % lie
  constexpr int kErrors = 200'000;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (const double across : {0.0, 0.02, 0.05, 0.1, 0.15, 0.2}) {
    Eigen::Matrix3d covariance = Eigen::Vector3d(0.04, across * across, 1.0).asDiagonal();
    const double radius = kRadii * round_position_sigma(covariance);
    int within = 0;
    for (int i = 0; i < kErrors; ++i) {
      within += std::hypot(0.2 * normal(random), across * normal(random)) < radius ? 1 : 0;
    }
    EXPECT_GT(within, 0.947 * kErrors) << across;
    EXPECT_LT(within, 0.962 * kErrors) << across;
  }
}

TEST(RoundPositionSigma, DoesNotDependOnTheDirection) {
  const Eigen::Rotation2Dd turn(0.7);
  Eigen::Matrix3d along = Eigen::Vector3d(0.04, 0.01, 1.0).asDiagonal();
  Eigen::Matrix3d slanted = along;
  slanted.topLeftCorner<2, 2>() =
      turn.toRotationMatrix() * along.topLeftCorner<2, 2>() * turn.inverse().toRotationMatrix();
  EXPECT_NEAR(round_position_sigma(slanted), round_position_sigma(along), 1e-12);
}

}  // namespace
}  // namespace luminav
