#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/create2/create2_config.hpp"
#include "services/common/configuration/robot_base.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "tests/node/create2/create2_bench.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;

TEST(Create2Node, ConnectsAndSwitchesItsMotorsOn) {
  Create2Bench bench;
  bench.run(2.0);
  EXPECT_TRUE(bench.node.connected());
  EXPECT_EQ(bench.board.mode(), OiMode::kSafe);
  const robot_status_t& status = bench.status.back();
  EXPECT_TRUE(status.connected);
  EXPECT_TRUE(status.motors_enabled);
  EXPECT_NEAR(status.battery_voltage, 15.1, 0.1);
  EXPECT_EQ(status.reason, "no fresh command");
}

TEST(Create2Node, KeepsTheContractOfABaseDriver) {
  Create2Bench bench;
  bench.run(2.0);
  CheckBaseNode check(bench.lcm, Create2Bench::robot_config().robot, bench.clock,
                      {.process = "create2", .drives = true, .key = {}});
  for (int i = 0; i < 60 && !check.exercise()->is_done(); ++i) {
    bench.run(1.0);
  }
  ASSERT_TRUE(check.exercise()->is_done());
  EXPECT_EQ(check.exercise()->refusal(), "");
  EXPECT_EQ(exit_status(check.clauses(), true), 0) << describe(check.clauses());
}

TEST(Create2Node, DrivesAsFarAsItsOdometrySays) {
  Create2Bench bench;
  bench.run(2.0);
  bench.drive(0.2, 0.0);
  bench.run(5.0);
  bench.drive(0.0, 0.0);
  bench.run(1.0);
  EXPECT_GT(bench.travel, 0.9);
  EXPECT_NEAR(bench.odometry.back().x, bench.travel, 0.002);
  EXPECT_EQ(bench.odometry.front().session, bench.odometry.back().session);
}

/// The simulated robot's bumper is pressed, or the floor ends; the way until it stands [m].
double way_until_it_stands(Create2Bench& bench) {
  const double before = bench.travel;
  bench.run(1.0);
  EXPECT_EQ(bench.speed(), 0.0);
  return bench.travel - before;
}

TEST(Create2Node, StopsAtOnceForABumperAndLetsOnlyGoBack) {
  Create2Bench bench;
  bench.run(2.0);
  bench.drive(0.2, 0.0);
  bench.run(2.0);
  bench.inputs.bumpers_front = 1;
  EXPECT_LT(way_until_it_stands(bench), 0.01) << "a frame and no ramp";
  EXPECT_EQ(bench.status.back().bumpers_front, HazardWatch::kBumpLeft);
  EXPECT_EQ(bench.status.back().reason, "it touches something on the left");
  bench.drive(-0.1, 0.0);
  bench.run(1.0);
  EXPECT_LT(bench.speed(), -0.09);
  bench.inputs.bumpers_front = 0;
  bench.drive(0.2, 0.0);
  bench.run(2.0);
  EXPECT_NEAR(bench.speed(), 0.2, 0.01);
}

TEST(Create2Node, StopsBeforeAnEdgeAndBacksOff) {
  for (const int sensor : {1, 2, 4, 8}) {
    Create2Bench bench;
    bench.run(2.0);
    bench.drive(0.2, 0.0);
    bench.run(2.0);
    bench.inputs.cliffs = sensor;
    EXPECT_LT(way_until_it_stands(bench), 0.01);
    EXPECT_EQ(bench.status.back().bumpers_front, 4 * sensor);
    EXPECT_THAT(bench.status.back().reason, HasSubstr("the floor ends"));
    bench.drive(-0.1, 0.0);
    bench.run(1.0);
    EXPECT_LT(bench.speed(), -0.09) << "the robot itself has left safe mode and was brought back";
  }
}

TEST(Create2Node, TakesThePowerOffAWheelInTheAirUntilItIsAskedAgain) {
  Create2Bench bench;
  bench.run(2.0);
  bench.drive(0.2, 0.0);
  bench.run(2.0);
  bench.inputs.wheel_drop_left = true;
  EXPECT_LT(way_until_it_stands(bench), 0.01);
  EXPECT_FALSE(bench.status.back().motors_enabled);
  EXPECT_THAT(bench.status.back().reason, HasSubstr("a wheel hung in the air"));
  bench.inputs.wheel_drop_left = false;
  bench.run(3.0);
  EXPECT_EQ(bench.speed(), 0.0);
  bench.send_motors(7, true);
  bench.run(3.0);
  EXPECT_NEAR(bench.speed(), 0.2, 0.01);
}

TEST(Create2Node, BeginsANewSessionWhenTheLineWasOut) {
  Create2Bench bench;
  bench.run(2.0);
  const std::int64_t session = bench.odometry.back().session;
  bench.plugged = false;
  bench.pipe.unplug();
  bench.run(1.0);
  EXPECT_FALSE(bench.status.back().connected);
  EXPECT_FALSE(bench.status.back().reason.empty());
  bench.pipe.plug_in();
  bench.plugged = true;
  bench.run(4.0);
  EXPECT_TRUE(bench.status.back().connected);
  EXPECT_GT(bench.odometry.back().session, session);
}

TEST(Create2Node, LeavesARobotWithoutPower) {
  Create2Bench bench;
  bench.run(2.0);
  bench.drive(0.2, 0.0);
  bench.run(2.0);
  bench.node.shut_down();
  bench.run(0.01);  // hears it
  EXPECT_EQ(bench.board.mode(), OiMode::kPassive);
  EXPECT_EQ(bench.speed(), 0.0);
}

TEST(Create2Config, IsReadFromTheShippedFileAndRefusesSonars) {
  const Create2Config config = read_create2_config(LUMINAV_SOURCE_DIR "/launch/robots/create2.toml");
  EXPECT_EQ(read_robot_base(LUMINAV_SOURCE_DIR "/launch/robots/create2.toml"), "create2");
  EXPECT_EQ(read_robot_base(LUMINAV_SOURCE_DIR "/launch/robots/p3dx.toml"), "p3dx");
  EXPECT_EQ(config.baud, 115200);
  EXPECT_LE(config.robot.limits.linear, 0.25) << "walking speed";
  EXPECT_TRUE(config.robot.sonar.robot_from_sonar.empty());
  EXPECT_THROW(read_create2_config(LUMINAV_SOURCE_DIR "/launch/robots/p3dx.toml"), ConfigurationError);
}

}  // namespace
}  // namespace luminav
