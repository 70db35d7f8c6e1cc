#include "services/controller/following/speed_law.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace luminav {
namespace {

TEST(SpeedLaw, DrivesFullSpeedOnAFreeStretch) {
  const DriveTwist twist = speed_law(0.0, 1.0, 10.0, {});
  EXPECT_DOUBLE_EQ(twist.linear, 0.5);
  EXPECT_DOUBLE_EQ(twist.angular, 0.0);
}

TEST(SpeedLaw, NeverSpeedsUpWithErrorWithLessRoomOrTowardsTheEnd) {
  for (double error = 0.0; error < 3.0; error += 0.1) {
    EXPECT_GE(speed_law(error, 1.0, 10.0, {}).linear, speed_law(error + 0.1, 1.0, 10.0, {}).linear);
  }
  for (double clearance = 0.0; clearance < 1.0; clearance += 0.05) {
    EXPECT_LE(speed_law(0.0, clearance, 10.0, {}).linear, speed_law(0.0, clearance + 0.05, 10.0, {}).linear);
  }
  for (double left = 0.0; left < 2.0; left += 0.1) {
    EXPECT_LE(speed_law(0.0, 1.0, left, {}).linear, speed_law(0.0, 1.0, left + 0.1, {}).linear);
  }
}

TEST(SpeedLaw, OnlyTurnsWhereItWouldDriveAway) {
  const DriveTwist twist = speed_law(2.0, 1.0, 10.0, {});
  EXPECT_DOUBLE_EQ(twist.linear, 0.0);
  EXPECT_DOUBLE_EQ(twist.angular, SpeedLawParams{}.angular);
  EXPECT_DOUBLE_EQ(speed_law(-2.0, 1.0, 10.0, {}).angular, -SpeedLawParams{}.angular);
}

TEST(CommandRamp, KeepsAccelerationAndJerk) {
  CommandRamp ramp({}, 1.0);
  double last_speed = 0.0;
  double last_acceleration = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double speed = ramp.step({0.5, 1.0}, 0.05).linear;
    const double acceleration = (speed - last_speed) / 0.05;
    EXPECT_LE(acceleration, MotionLimits{}.linear_acceleration + 1e-9);
    EXPECT_LE(acceleration - last_acceleration, 1.0 * 0.05 + 1e-9);
    EXPECT_LE(speed, 0.5 + 1e-12);
    last_speed = speed;
    last_acceleration = acceleration;
  }
  EXPECT_NEAR(last_speed, 0.5, 1e-6);
}

TEST(CommandRamp, BrakesWithoutSoftening) {
  CommandRamp ramp({}, 1.0);
  ramp.restart_from({0.5, 0.0});
  EXPECT_NEAR(ramp.step({0.0, 0.0}, 0.1).linear, 0.4, 1e-12);
}

TEST(CommandRamp, StopsBeforeItGoesTheOtherWay) {
  CommandRamp ramp({}, 1.0);
  ramp.restart_from({0.05, 0.0});
  EXPECT_DOUBLE_EQ(ramp.step({-0.3, 0.0}, 0.1).linear, 0.0);
  EXPECT_LT(ramp.step({-0.3, 0.0}, 0.1).linear, 0.0);
}

TEST(CommandRamp, AStepAgainReplacesTheLast) {
  CommandRamp ramp({}, 1.0);
  CommandRamp once({}, 1.0);
  for (CommandRamp* each : {&ramp, &once}) {
    each->restart_from({0.2, 0.0});
    (void)each->step({0.5, 0.0}, 0.04);
  }
  (void)ramp.step({0.0, 1.0}, 0.04);
  ramp.restart_from({0.1, 0.0});  // the stop logic had a word
  const DriveTwist again = ramp.step_again({0.5, 0.3});
  const DriveTwist only = once.step({0.5, 0.3}, 0.04);
  EXPECT_EQ(again.linear, only.linear);
  EXPECT_EQ(again.angular, only.angular);
}

TEST(CommandRamp, AStepAgainAfterAStopBeginsAtRest) {
  CommandRamp ramp({}, 1.0);
  ramp.restart_from({0.5, 0.5});
  (void)ramp.step({0.5, 0.5}, 0.04);
  ramp.stop();
  EXPECT_LT(ramp.step_again({0.5, 0.0}).linear, 0.01);
}

}  // namespace
}  // namespace luminav
