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

}  // namespace
}  // namespace luminav
