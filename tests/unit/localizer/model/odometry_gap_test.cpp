#include "services/localizer/model/odometry_gap.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace luminav {
namespace {

TEST(OdometryGap, IsNoneWhileOdometryGoesOnAfterASilence) {
  const OdometryReading last{1'000'000, 7, {2.0, 1.0, 0.5}, 0.5, 0.0};
  EXPECT_EQ(find_gap(last, {3'000'000, 7, {2.8, 1.2, 0.5}, 0.5, 0.0}), "");
}

TEST(OdometryGap, IsThereAfterANewSessionAndAfterAJump) {
  const OdometryReading last{1'000'000, 7, {2.0, 1.0, 0.5}, 0.5, 0.0};
  EXPECT_NE(find_gap(last, {1'100'000, 8, {2.0, 1.0, 0.5}, 0.5, 0.0}), "");
  EXPECT_NE(find_gap(last, {1'100'000, 7, {3.0, 1.0, 0.5}, 0.5, 0.0}), "");
}

TEST(OdometryGap, LeavesOpenWhetherTheRobotStoppedAtOnceOrDroveOnUntilItsWatchdog) {
  const OdometryGap gap = odometry_gap({0, 1, {}, 0.5, 0.0}, {5'000'000, 2, {}, 0.0, 0.0});
  EXPECT_NEAR(gap.step.x, 0.6, 0.1);
  EXPECT_NEAR(gap.step.y, 0.0, 1e-9);
  for (const double distance : {0.0, 1.2}) {  // both ends within two deviations
    EXPECT_LT(std::abs(gap.step.x - distance), 2.0 * std::sqrt(gap.noise(0, 0)));
  }
  EXPECT_GT(gap.noise(0, 0), 2.0 * gap.noise(1, 1));
}

TEST(OdometryGap, FollowsTheArcOfATurningRobot) {
  const OdometryGap gap = odometry_gap({0, 1, {}, 0.4, 0.5}, {1'000'000, 2, {}, 0.0, 0.0});
  // half a second of the last twist: radius 0.8 m
  EXPECT_NEAR(gap.step.x, 0.8 * std::sin(0.25), 1e-9);
  EXPECT_NEAR(gap.step.y, 0.8 * (1.0 - std::cos(0.25)), 1e-9);
  EXPECT_NEAR(gap.step.theta, 0.25, 1e-9);
  EXPECT_GT(gap.noise(0, 2), 0.0);
}

TEST(OdometryGap, AssumesNoMotionWhereTimeWentBack) {
  const OdometryGap gap = odometry_gap({9'000'000, 1, {}, 0.5, 0.5}, {1'000'000, 2, {}, 0.0, 0.0});
  EXPECT_EQ(gap.step.x, 0.0);
  EXPECT_EQ(gap.step.theta, 0.0);
  EXPECT_TRUE(gap.noise.allFinite());
  EXPECT_FALSE(gap.may_be_kidnapped);
}

TEST(OdometryGap, OnlyALongOneLeavesTimeToCarryTheRobot) {
  const OdometryReading last{0, 1, {}, 0.5, 0.0};
  EXPECT_FALSE(odometry_gap(last, {4'000'000, 2, {}, 0.0, 0.0}).may_be_kidnapped);
  EXPECT_TRUE(odometry_gap(last, {20'000'000, 2, {}, 0.0, 0.0}).may_be_kidnapped);
}

TEST(Extrapolation, FollowsTheArcOfTheLastTwist) {
  const OdometryReading newest{1'000'000, 1, {3.0, 2.0, 1.0}, 0.5, 1.0};
  const OdometryGap ahead = extrapolate(newest, 1'100'000);
  // a circle of half a metre
  EXPECT_NEAR(ahead.step.x, 0.5 * std::sin(0.1), 1e-12);
  EXPECT_NEAR(ahead.step.y, 0.5 * (1.0 - std::cos(0.1)), 1e-12);
  EXPECT_NEAR(ahead.step.theta, 0.1, 1e-12);
  EXPECT_FALSE(ahead.may_be_kidnapped);
}

TEST(Extrapolation, GrowsLessSureWithTheTimeSquared) {
  const OdometryReading newest{1'000'000, 1, {}, 0.5, 0.0};
  const Eigen::Matrix3d soon = extrapolate(newest, 1'050'000).noise;
  const Eigen::Matrix3d late = extrapolate(newest, 1'100'000).noise;
  EXPECT_NEAR(std::sqrt(late(0, 0)), 0.005, 1e-12) << "braking with 1 m/s^2";
  EXPECT_NEAR(std::sqrt(late(0, 0) / soon(0, 0)), 4.0, 1e-9);
  EXPECT_NEAR(std::sqrt(late(2, 2) / soon(2, 2)), 4.0, 1e-9);
  EXPECT_EQ(extrapolate(newest, newest.utime).noise.norm(), 0.0);
}

}  // namespace
}  // namespace luminav
