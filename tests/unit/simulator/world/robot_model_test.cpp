#include "drivers/simulator/world/robot_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/simulator/text_world.hpp"

namespace luminav {
namespace {

constexpr double kTick = 0.01;

struct Drive {
  Pose2 pose;
  double left = 0.0;
  double right = 0.0;
  double fastest_change = 0.0;  // [m/s^2] of a wheel
};

/// Drives until the mean wheel travel is `distance`, or for `ticks`.
Drive drive(RobotModel& robot, const MotorCommand& command, double distance, int ticks = 1'000'000) {
  Drive result;
  double previous = 0.0;
  for (int i = 0; i < ticks && 0.5 * (std::abs(result.left) + std::abs(result.right)) < distance; ++i) {
    const WheelStep step = robot.step(kTick, command);
    result.left += step.left;
    result.right += step.right;
    result.pose = result.pose * step.robot_from_next;
    result.fastest_change = std::max(result.fastest_change, std::abs(step.left - previous) / (kTick * kTick));
    previous = step.left;
  }
  return result;
}

WorldTruth perfect() {
  return exact_truth({}, {});
}

TEST(RobotModel, DrivesStraightWhenAllIsAsBelieved) {
  RobotModel robot(perfect(), 1);
  const Drive result = drive(robot, {0.5, 0.0, true}, 2.0);
  EXPECT_NEAR(result.pose.x, result.left, 1e-9);
  EXPECT_NEAR(result.pose.y, 0.0, 1e-12);
  EXPECT_NEAR(result.pose.theta, 0.0, 1e-12);
}

TEST(RobotModel, TurnsOnTheSpotByTheBaseItBelieves) {
  WorldTruth truth = perfect();
  RobotModel believed(truth, 1);
  // one radian per second for as long as it takes until the right wheel has gone half a base
  EXPECT_NEAR(drive(believed, {0.0, 1.0, true}, 0.5 * 0.33).pose.theta, 1.0, 0.01);
  truth.robot.wheel_base *= 1.10;
  RobotModel wider(truth, 1);
  EXPECT_NEAR(drive(wider, {0.0, 1.0, true}, 0.5 * 0.33).pose.theta, 1.0 / 1.10, 0.01);
}

TEST(RobotModel, CoversMoreGroundThanTheEncodersSayWithLargerWheels) {
  WorldTruth truth = perfect();
  truth.wheels.scale_left = truth.wheels.scale_right = 1.02;
  RobotModel robot(truth, 1);
  const Drive result = drive(robot, {0.5, 0.0, true}, 3.0);
  EXPECT_NEAR(result.pose.x, 1.02 * result.left, 1e-9);
}

TEST(RobotModel, DrivesACurveWithUnequalWheels) {
  WorldTruth truth = perfect();
  truth.wheels.scale_left = 0.995;
  truth.wheels.scale_right = 1.005;
  RobotModel robot(truth, 1);
  const Drive result = drive(robot, {0.5, 0.0, true}, 1.0);
  EXPECT_NEAR(result.pose.theta, 0.010 * result.left / 0.33, 1e-6);
}

TEST(RobotModel, SlipsWithLessGrip) {
  RobotModel robot(perfect(), 1);
  robot.set_grip(0.9);
  const Drive result = drive(robot, {0.5, 0.0, true}, 1.0);
  EXPECT_NEAR(result.pose.x, 0.9 * result.left, 1e-9);
}

TEST(RobotModel, SpinsOrStallsWhileItIsHeldAsDrawnWhenThatBegins) {
  RobotModel robot(perfect(), 1);
  int spins = 0;
  for (int i = 0; i < 1000; ++i) {
    const bool is_spinning = robot.hold(true);
    spins += is_spinning ? 1 : 0;
    ASSERT_EQ(robot.hold(false), is_spinning);
  }
  EXPECT_NEAR(spins, 300, 45);  // 3 sigma
}

TEST(RobotModel, DoesNotMoveWithoutPowerAndStandsWithoutNoise) {
  WorldTruth truth = perfect();
  truth.wheels.noise_position = 0.01;
  truth.wheels.noise_heading = radians(0.5);
  RobotModel robot(truth, 1);
  const Drive off = drive(robot, {0.5, 0.3, false}, 1.0, 500);
  EXPECT_EQ(off.left, 0.0);
  EXPECT_EQ(off.pose.x, 0.0);
  drive(robot, {0.5, 0.0, true}, 1.0);
  drive(robot, {0.0, 0.0, true}, 10.0, 200);
  const Drive standing = drive(robot, {0.0, 0.0, true}, 1.0, 1000);
  EXPECT_EQ(standing.pose.x, 0.0);
  EXPECT_EQ(standing.pose.theta, 0.0);
}

TEST(RobotModel, FollowsACommandWithinTractionAndShortly) {
  RobotModel robot(perfect(), 1);
  const Drive start = drive(robot, {0.5, 0.0, true}, 100.0, 30);
  EXPECT_LE(start.fastest_change, 4.0 + 1e-9);
  const Drive later = drive(robot, {0.5, 0.0, true}, 100.0, 100);
  EXPECT_NEAR(later.left, 0.5, 0.01);
}

// 1 cm and 0.5 degrees per square root of a metre, over 1 m and over 4 m.
TEST(RobotModel, SpreadsWithTheSquareRootOfTheWay) {
  WorldTruth truth = perfect();
  truth.wheels.noise_position = 0.01;
  truth.wheels.noise_heading = radians(0.5);
  constexpr int kRuns = 1500;
  for (const double distance : {1.0, 4.0}) {
    double squares_x = 0.0;
    double squares_theta = 0.0;
    for (int seed = 0; seed < kRuns; ++seed) {
      RobotModel robot(truth, static_cast<std::uint64_t>(seed));
      const Drive result = drive(robot, {0.5, 0.0, true}, distance);
      squares_theta += result.pose.theta * result.pose.theta;
      // along the curved way, so that the heading's error stays out of it
      const double along =
          result.pose.x * std::cos(0.5 * result.pose.theta) + result.pose.y * std::sin(0.5 * result.pose.theta);
      squares_x += std::pow(along - result.left, 2);
    }
    const double tolerance = 4.0 / std::sqrt(2.0 * kRuns);
    EXPECT_NEAR(std::sqrt(squares_x / kRuns) / (0.01 * std::sqrt(distance)), 1.0, tolerance + 0.03);
    EXPECT_NEAR(std::sqrt(squares_theta / kRuns) / (radians(0.5) * std::sqrt(distance)), 1.0, tolerance);
  }
}

}  // namespace
}  // namespace luminav
