#include "services/localizer/hypotheses/pose_alternatives.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav {
namespace {

constexpr double kTolerance = 1e-12;

/// A bank in a corridor that holds what it is told.
class PoseAlternatives : public ::testing::Test {
 protected:
  void hold(const Pose2& pose, double log_posterior, double sonar_part = 0.0) {
    bank_.add_guess({pose, Eigen::Vector3d(0.03, 0.05, 0.01).asDiagonal()}, 0.0);
    bank_.hypotheses().back().log_posterior = log_posterior;
    bank_.hypotheses().back().sonar_part = sonar_part;
  }

  testing::TestBuilding corridor_ = testing::symmetric_corridor(4, 3.0);
  ObservationModel model_{corridor_.building, corridor_.walls, RobotDescription{}, ErrorParams{}};
  HypothesisBank bank_{model_, HypothesisParams{}};
};

TEST_F(PoseAlternatives, AreNoneWhereNoPoseIsPossible) {
  EXPECT_TRUE(weigh(bank_, {}, 10).empty());
}

TEST_F(PoseAlternatives, WeighWhatTheirScoresAreTheLogarithmsOf) {
  hold({1.0, 1.0, 0.0}, -2.0);
  hold({2.0, 1.0, 0.0}, -2.0 - std::log(3.0));
  const std::vector<WeightedPose> poses = weigh(bank_, {}, 10);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_NEAR(poses[0].weight, 0.75, kTolerance);
  EXPECT_NEAR(poses[1].weight, 0.25, kTolerance);
  EXPECT_NEAR(poses[1].position_sigma, 0.2, kTolerance);
}

TEST_F(PoseAlternatives, AreSharesOfAllWhereNotAllAreListed) {
  hold({1.0, 1.0, 0.0}, 0.0);
  hold({2.0, 1.0, 0.0}, 0.0);
  hold({3.0, 1.0, 0.0}, 0.0);
  hold({4.0, 1.0, 0.0}, 0.0);
  const std::vector<WeightedPose> poses = weigh(bank_, {}, 1);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_NEAR(poses[0].weight, 0.25, kTolerance);
}

TEST_F(PoseAlternatives, AreCarriedAheadInTheirOwnFrames) {
  hold({1.0, 1.0, 0.5 * kPi}, 0.0);
  const std::vector<WeightedPose> poses = weigh(bank_, {0.5, 0.0, 0.1}, 1);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_NEAR(poses[0].pose.x, 1.0, kTolerance);
  EXPECT_NEAR(poses[0].pose.y, 1.5, kTolerance);
  EXPECT_NEAR(poses[0].pose.theta, 0.5 * kPi + 0.1, kTolerance);
}

TEST_F(PoseAlternatives, AreNotToldApartByWhatOnlySonarSays) {
  hold({1.0, 1.0, 0.0}, 0.0);
  hold({2.0, 1.0, 0.0}, -12.0, -12.0);
  hold({3.0, 1.0, 0.0}, -12.0, -1.0);
  const std::vector<WeightedPose> poses = weigh(bank_, {}, 10);
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_GT(poses[1].weight, 0.01 * poses[0].weight);
  EXPECT_NEAR(poses[2].weight, std::exp(-12.0) * poses[0].weight, kTolerance);
}

TEST_F(PoseAlternatives, CountFromTheBestByTheCeilingEvenIfSonarPutsItBehind) {
  hold({1.0, 1.0, 0.0}, -6.0);
  hold({2.0, 1.0, 0.0}, -10.0, -10.0);
  const std::vector<WeightedPose> poses = weigh(bank_, {}, 10);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_GT(poses[1].weight, poses[0].weight);
  EXPECT_NEAR(poses[0].weight + poses[1].weight, 1.0, kTolerance);
}

TEST(WidenOver, AddsWhatThePossiblePosesLieApart) {
  PoseBelief belief{{1.0, 2.0, 0.0}, 0.01 * Eigen::Matrix3d::Identity()};
  widen_over({{{1.0, 2.0, 0.0}, 0.5, 0.0}, {{4.0, -2.0, 0.0}, 0.25, 0.0}}, belief);
  EXPECT_NEAR(belief.covariance(0, 0), 0.01 + 0.25 * 9.0, kTolerance);
  EXPECT_NEAR(belief.covariance(1, 1), 0.01 + 0.25 * 16.0, kTolerance);
  EXPECT_NEAR(belief.covariance(0, 1), 0.25 * -12.0, kTolerance);
  EXPECT_NEAR(belief.covariance(1, 0), 0.25 * -12.0, kTolerance);
  EXPECT_NEAR(belief.covariance(2, 2), 0.01, kTolerance);
}

TEST(WidenOver, TakesTheShortWayBetweenHeadings) {
  PoseBelief belief{{0.0, 0.0, kPi - 0.1}, Eigen::Matrix3d::Zero()};
  widen_over({{{0.0, 0.0, 0.2 - kPi}, 0.5, 0.0}}, belief);
  EXPECT_NEAR(belief.covariance(2, 2), 0.5 * 0.09, kTolerance);
}

}  // namespace
}  // namespace luminav
