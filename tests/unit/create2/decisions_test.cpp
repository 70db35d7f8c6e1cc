#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/create2/hazard_watch.hpp"
#include "drivers/create2/oi/oi_commands.hpp"
#include "drivers/create2/oi/stream_parser.hpp"
#include "drivers/create2/power_supervisor.hpp"
#include "drivers/create2/safety/oi_guard.hpp"
#include "drivers/create2/wheel_odometry.hpp"
#include "drivers/create2/wheel_writer.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kFrame = 15'000;         // [us]
constexpr double kCount = kPi * 0.072 / 508.8;  // [m]

SensorReading counts(int left, int right) {
  SensorReading reading;
  reading.left_count = static_cast<std::uint16_t>(left);
  reading.right_count = static_cast<std::uint16_t>(right);
  return reading;
}

TEST(WheelOdometry, CountsStraightOnOverManyWraps) {
  WheelOdometry odometry({});
  constexpr int kStep = 15;  // counts a frame, 0.44 m/s
  constexpr int kFrames = 20'000;
  for (int i = 0; i <= kFrames; ++i) {
    ASSERT_EQ(odometry.update(counts(i * kStep, i * kStep), i * kFrame), WheelOdometry::Verdict::kAccepted);
  }
  EXPECT_NEAR(odometry.odom_from_robot().x, kFrames * kStep * kCount, 1e-6) << "four wraps";
  EXPECT_NEAR(odometry.odom_from_robot().y, 0.0, 1e-9);
}

TEST(WheelOdometry, TurnsOnTheSpotByTheWheelBase) {
  WheelOdometry odometry({});
  for (int i = 0; i <= 100; ++i) {
    odometry.update(counts(-4 * i, 4 * i), i * kFrame);
  }
  EXPECT_NEAR(odometry.odom_from_robot().theta, 800 * kCount / 0.235, 1e-9);
  EXPECT_NEAR(odometry.odom_from_robot().x, 0.0, 1e-9);
  odometry.measure_twist(50 * kFrame);
  odometry.measure_twist(100 * kFrame);
  EXPECT_EQ(odometry.angular(), 0.0) << "nothing since";
}

TEST(WheelOdometry, RefusesOneDamagedFrameAndBelievesThree) {
  WheelOdometry odometry({});
  odometry.update(counts(0, 0), 0);
  EXPECT_EQ(odometry.update(counts(20'000, 0), 1 * kFrame), WheelOdometry::Verdict::kRefused);
  EXPECT_EQ(odometry.update(counts(5, 5), 2 * kFrame), WheelOdometry::Verdict::kAccepted);
  EXPECT_EQ(odometry.update(counts(9000, 9000), 3 * kFrame), WheelOdometry::Verdict::kRefused);
  EXPECT_EQ(odometry.update(counts(9001, 9001), 4 * kFrame), WheelOdometry::Verdict::kRefused);
  EXPECT_EQ(odometry.update(counts(9002, 9002), 5 * kFrame), WheelOdometry::Verdict::kJumped);
  EXPECT_NEAR(odometry.odom_from_robot().x, 5 * kCount, 1e-9);
}

TEST(HazardWatch, ForbidsWhatLeadsOnAndLetsGoBack) {
  HazardWatch hazards;
  SensorReading reading;
  EXPECT_FALSE(hazards.update(reading));
  EXPECT_FALSE(hazards.forbids({0.2, 0.0}));
  reading.cliff_front_left = true;
  EXPECT_TRUE(hazards.update(reading));
  EXPECT_FALSE(hazards.update(reading)) << "no news";
  EXPECT_TRUE(hazards.forbids({0.2, 0.0}));
  EXPECT_TRUE(hazards.forbids({0.01, 0.5}));
  EXPECT_FALSE(hazards.forbids({-0.1, 0.0}));
  EXPECT_FALSE(hazards.forbids({-0.12, 0.5}));
  EXPECT_TRUE(hazards.forbids({0.0, 0.5}));
  EXPECT_TRUE(hazards.forbids({-0.05, 0.5})) << "narrower than itself";
  EXPECT_FALSE(hazards.forbids({})) << "stands";
  EXPECT_EQ(hazards.reason(), "the floor ends on the left");
  EXPECT_EQ(hazards.bumpers(), HazardWatch::kCliffFrontLeft);
  reading.bump_right = true;
  EXPECT_TRUE(hazards.update(reading)) << "one more";
}

TEST(HazardWatch, LetsARobotThatTouchesSomethingTurn) {
  HazardWatch hazards;
  SensorReading reading;
  reading.bump_right = true;
  EXPECT_TRUE(hazards.update(reading));
  EXPECT_TRUE(hazards.forbids({0.01, 0.5}));
  EXPECT_FALSE(hazards.forbids({0.0, 0.5}));
  EXPECT_FALSE(hazards.forbids({-0.05, 0.5}));
}

TEST(HazardWatch, ForbidsAllMotionOfAWheelInTheAir) {
  HazardWatch hazards;
  SensorReading reading;
  reading.wheel_drop_right = true;
  EXPECT_TRUE(hazards.update(reading));
  EXPECT_TRUE(hazards.forbids({-0.1, 0.0}));
  EXPECT_FALSE(hazards.forbids({}));
  EXPECT_EQ(hazards.reason(), "a wheel hangs in the air");
}

/// A robot that answers a mode at once.
struct Robot {
  std::optional<OiOpcode> step(std::int64_t now) {
    hazards.update(reading);
    const auto mode = power.update(reading, hazards, now);
    if (mode) {
      reading.mode = *mode == OiOpcode::kSafe ? OiMode::kSafe : OiMode::kPassive;
    }
    return mode;
  }
  SensorReading reading{.mode = OiMode::kPassive};
  HazardWatch hazards;
  PowerSupervisor power{true};
};

TEST(PowerSupervisor, GoesToSafeModeAndBackToItAtACliff) {
  Robot robot;
  EXPECT_EQ(robot.step(1'000'000), OiOpcode::kSafe);
  EXPECT_EQ(robot.step(1'100'000), std::nullopt);
  EXPECT_EQ(robot.power.reason(), "");
  robot.reading.cliff_left = true;
  robot.reading.mode = OiMode::kPassive;
  EXPECT_EQ(robot.step(1'200'000), OiOpcode::kSafe) << "to back off";
}

TEST(PowerSupervisor, DoesNotFightWithWhoSwitchesItOff) {
  Robot robot;
  robot.step(1'000'000);
  robot.step(1'100'000);
  robot.reading.mode = OiMode::kPassive;
  EXPECT_EQ(robot.step(3'000'000), std::nullopt);
  EXPECT_EQ(robot.step(9'000'000), std::nullopt);
  EXPECT_THAT(robot.power.reason(), testing::HasSubstr("enable them again"));
  robot.power.request(true);
  EXPECT_EQ(robot.step(9'100'000), OiOpcode::kSafe);
}

TEST(PowerSupervisor, WantsARequestAfterAWheelHungInTheAir) {
  Robot robot;
  robot.step(1'000'000);
  robot.step(1'100'000);
  robot.reading.wheel_drop_left = true;
  EXPECT_EQ(robot.step(1'200'000), OiOpcode::kStart);
  robot.reading.wheel_drop_left = false;
  EXPECT_EQ(robot.step(5'000'000), std::nullopt);
  EXPECT_THAT(robot.power.reason(), testing::HasSubstr("put the robot down"));
}

TEST(WheelWriter, RampsUpAndDownAndStandsAtOnceWhenHalted) {
  WheelWriter writer({.linear = 0.2, .linear_acceleration = 0.4, .linear_deceleration = 0.8}, 0.235);
  std::vector<std::uint8_t> sent;
  for (int i = 0; i < 100; ++i) {
    if (const auto command = writer.poll({0.2, 0.0}, 1'000'000 + 20'000 * i)) {
      sent = *command;
    }
    const int after = i * 20;  // [ms]
    if (after == 240) {
      EXPECT_NEAR(sent[2], 104, 9) << "0.26 s of 0.4 m/s^2";
    }
  }
  EXPECT_EQ(sent, encode_drive_direct(200, 200));
  EXPECT_EQ(writer.halt(3'000'000), encode_drive_direct(0, 0));
  EXPECT_EQ(writer.poll({}, 3'200'000), encode_drive_direct(0, 0)) << "said again";
}

TEST(GuardedCreate2, BelievesThatWheelsStandOnceTwoFramesCountTheSame) {
  GuardedRobot robot = guarded_create2();
  const auto hear = [&](int left) {
    return robot.hear_wheels(encode_stream_frame(encode_readings(counts(left, 0), wanted_readings())));
  };
  EXPECT_EQ(hear(0), false) << "one alone says nothing";
  EXPECT_EQ(hear(5), false);
  EXPECT_EQ(hear(5), true);
  EXPECT_EQ(robot.hear_wheels({}), std::nullopt);
  EXPECT_EQ(robot.leave.back(), 128) << "passive: no power";
}

}  // namespace
}  // namespace luminav
