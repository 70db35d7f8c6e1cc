#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <limits>

#include "tests/node/p3dx/p3dx_bench.hpp"
#include "tests/support/temporary_folder.hpp"

namespace luminav {
namespace {

using testing::HasSubstr;

TEST(P3dxNode, ConnectsAndSwitchesTheMotorsOn) {
  P3dxBench bench;
  bench.run(2.0);
  ASSERT_FALSE(bench.status.empty());
  EXPECT_TRUE(bench.status.back().connected);
  EXPECT_TRUE(bench.status.back().motors_enabled);
  EXPECT_TRUE(bench.base.outputs.motors_enabled);
  EXPECT_NEAR(bench.status.back().deceleration, 1.0, 1e-9);  // as the robot reads it back
  EXPECT_NE(bench.status.back().session, 0);
}

TEST(P3dxNode, PublishesStatusAt50HzAndOdometryAndSonarAt10Hz) {
  P3dxBench bench;
  bench.run(2.0);
  bench.status.clear();
  bench.odometry.clear();
  bench.sonar.clear();
  bench.run(10.0);
  EXPECT_NEAR(static_cast<double>(bench.status.size()), 500.0, 1.0);
  EXPECT_NEAR(static_cast<double>(bench.odometry.size()), 100.0, 1.0);
  EXPECT_EQ(bench.odometry.size(), bench.sonar.size());
}

TEST(P3dxNode, DrivesAsCommandedAndMeasuresIt) {
  P3dxBench bench;
  bench.run(2.0);
  bench.drive(0.3, 0.0);
  bench.run(10.0);
  EXPECT_NEAR(bench.base.outputs.linear, 0.3, 1e-9);
  EXPECT_NEAR(bench.odometry.back().linear, 0.3, 1e-3);
  EXPECT_NEAR(bench.odometry.back().x, bench.base.travel, 0.04);  // one cycle behind
  EXPECT_TRUE(bench.status.back().command_fresh);
  EXPECT_EQ(bench.status.back().reason, "");
}

TEST(P3dxNode, RefusesARobotOfUnknownSubclassUnlessAsked) {
  ArcosConfig arcos;
  arcos.flash.subclass = "peoplebot-sh";
  P3dxBench bench(arcos);
  bench.run(3.0);
  EXPECT_FALSE(bench.status.back().connected);
  EXPECT_THAT(bench.status.back().reason, HasSubstr("peoplebot-sh"));
  P3dxConfig config = P3dxBench::robot_config();
  config.assume_p3dx_sh = true;
  P3dxBench assumed(arcos, config);
  assumed.run(3.0);
  EXPECT_TRUE(assumed.status.back().connected);
}

TEST(P3dxNode, StopsWhenCommandsEnd) {
  P3dxBench bench;
  bench.run(2.0);
  bench.drive(0.4, 0.3);
  bench.run(3.0);
  EXPECT_NEAR(bench.base.outputs.linear, 0.4, 1e-9);
  bench.driving = false;
  bench.run(0.3 + 0.4 / 1.0 + 0.15);  // timeout, deceleration and a margin
  EXPECT_TRUE(bench.standing());
  EXPECT_FALSE(bench.status.back().command_fresh);
  EXPECT_EQ(bench.status.back().reason, "no fresh command");
}

TEST(P3dxNode, NeverMovesOnABacklog) {
  P3dxBench bench;
  bench.run(2.0);
  for (int i = 0; i < 200; ++i) {
    bench.send_command(bench.clock.utime() - 2'000'000 + 1'000 * i, 1, i, 0.5);
  }
  bench.run(2.0);
  EXPECT_EQ(bench.base.travel, 0.0);
  EXPECT_EQ(bench.status.back().commands_refused, 200);
}

TEST(P3dxNode, RefusesCommandsThatMakeNoSense) {
  P3dxBench bench;
  bench.run(2.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  bench.send_command(bench.clock.utime(), 1, 1, nan);
  bench.send_command(bench.clock.utime(), 1, 2, 0.1, std::numeric_limits<double>::infinity());
  bench.send_command(bench.clock.utime() + 10'000'000, 1, 3, 0.1);
  bench.lcm.publish(channels::kVelocityCommand, "rubbish", 7);
  bench.run(1.0);
  EXPECT_EQ(bench.base.travel, 0.0);
  EXPECT_EQ(bench.status.back().commands_refused, 1) << "those that are no numbers do not get that far";
  EXPECT_EQ(bench.node.health().dropped_inputs, 4);
}

TEST(P3dxNode, RefusesCommandsForAnotherRobot) {
  P3dxBench bench;
  bench.run(2.0);
  bench.addressee = "another";
  bench.drive(0.4, 0.0);
  bench.run(1.0);
  EXPECT_EQ(bench.base.travel, 0.0);
  EXPECT_GT(bench.node.health().dropped_inputs, 0);
  bench.addressee = P3dxBench::robot_config().robot.name;
  bench.run(1.0);
  EXPECT_GT(bench.base.travel, 0.1);
}

TEST(P3dxNode, StandsStillWhileAStopIsInForce) {
  P3dxBench bench;
  bench.run(2.0);
  bench.drive(0.4, 0.0);
  bench.run(2.0);
  bench.send_stop(10, true, "viewer");
  bench.run(0.6);
  EXPECT_TRUE(bench.standing());
  EXPECT_TRUE(bench.status.back().stop_engaged);
  EXPECT_EQ(bench.status.back().stop_id, 10);
  EXPECT_THAT(bench.status.back().reason, HasSubstr("viewer"));
  const double travel = bench.base.travel;
  bench.send_stop(9, false, "viewer");  // an older one
  bench.run(2.0);
  EXPECT_EQ(bench.base.travel, travel);
  EXPECT_TRUE(bench.status.back().motors_enabled);
  bench.send_stop(11, false, "viewer");
  bench.run(2.0);
  EXPECT_EQ(bench.status.back().stop_id, 11);
  EXPECT_NEAR(bench.base.outputs.linear, 0.4, 1e-9);
}

TEST(P3dxNode, StandsForAsLongAsItIsHeldAndSaysWhy) {
  P3dxBench bench;
  bench.run(2.0);
  bench.drive(0.4, 0.0);
  bench.run(2.0);
  bench.node.hold("two controllers on this network: desk, robot");
  bench.run(0.6);
  EXPECT_TRUE(bench.standing());
  EXPECT_EQ(bench.status.back().reason, "two controllers on this network: desk, robot");
  bench.node.hold("");
  bench.run(2.0);
  EXPECT_NEAR(bench.base.outputs.linear, 0.4, 1e-9);
}

TEST(P3dxNode, IgnoresARecordedRequestForTheMotors) {
  P3dxBench bench;
  bench.run(2.0);
  bench.send_motors(100, false);
  bench.run(1.0);
  bench.send_motors(50, true);  // never heard before, but from before the last
  bench.run(2.0);
  EXPECT_FALSE(bench.status.back().motors_enabled);
  EXPECT_EQ(bench.status.back().motors_command_id, 100);
}

TEST(P3dxNode, ObeysAStopThatHasTheIdOfARelease) {
  P3dxBench bench;
  bench.run(2.0);
  bench.drive(0.4, 0.0);
  bench.send_stop(100, true, "viewer");
  bench.send_stop(101, false, "viewer");
  bench.run(2.0);
  EXPECT_FALSE(bench.standing());
  bench.send_stop(101, true, "viewer");  // two pages counted on from the same id
  bench.run(0.6);
  EXPECT_TRUE(bench.status.back().stop_engaged);
  EXPECT_TRUE(bench.standing());
}

void say_somebody_watches(P3dxBench& bench) {
  supervision_t supervision{};
  supervision.utime = bench.clock.utime();
  bench.lcm.publish(channels::kSupervision, &supervision);
}

TEST(P3dxNode, StandsWhenNobodyWatchesAndUntilSomebodyReleasesIt) {
  P3dxConfig config = P3dxBench::robot_config();
  config.supervised = 3.0;
  P3dxBench bench({}, config);
  bench.drive(0.4, 0.0);
  for (int i = 0; i < 10; ++i) {
    say_somebody_watches(bench);
    bench.run(1.0);
    EXPECT_FALSE(bench.status.back().stop_engaged) << i;
  }
  EXPECT_NEAR(bench.base.outputs.linear, 0.4, 1e-9);
  bench.run(3.0);
  EXPECT_TRUE(bench.standing());
  EXPECT_TRUE(bench.status.back().stop_engaged);
  EXPECT_THAT(bench.status.back().reason, HasSubstr("no page and no operator for 3 s"));
  say_somebody_watches(bench);
  bench.run(1.0);
  EXPECT_TRUE(bench.standing()) << "it does not begin to move because somebody looks";
  bench.send_stop(7, false, "viewer");
  bench.run(1.0);
  EXPECT_FALSE(bench.standing());
}

TEST(P3dxNode, NeedsNobodyWhileItStands) {
  P3dxConfig config = P3dxBench::robot_config();
  config.supervised = 3.0;
  P3dxBench bench({}, config);
  bench.drive(0.0, 0.0);
  bench.run(20.0);
  EXPECT_FALSE(bench.status.back().stop_engaged);
  say_somebody_watches(bench);
  bench.drive(0.2, 0.0);
  bench.run(2.0);
  EXPECT_FALSE(bench.standing());
}

TEST(P3dxNode, LeavesTheMotorsOffUntilRequestedAndSwitchesThemOffAgain) {
  P3dxConfig config = P3dxBench::robot_config();
  config.enable_motors_at_start = false;
  P3dxBench bench({}, config);
  bench.drive(0.3, 0.0);
  bench.run(3.0);
  EXPECT_FALSE(bench.status.back().motors_enabled);
  EXPECT_NE(bench.status.back().reason, "");
  bench.send_motors(5, true);
  bench.run(2.0);
  EXPECT_TRUE(bench.status.back().motors_enabled);
  EXPECT_EQ(bench.status.back().motors_command_id, 5);
  EXPECT_GT(bench.base.travel, 0.1);
  bench.send_motors(6, false);
  bench.run(1.0);
  EXPECT_FALSE(bench.base.outputs.motors_enabled);
}

TEST(P3dxNode, WaitsForANewRequestAfterTheStopButton) {
  P3dxBench bench;
  bench.drive(0.3, 0.0);
  bench.run(3.0);
  bench.base.inputs.stop_button = true;
  bench.run(1.0);
  EXPECT_TRUE(bench.status.back().stop_button);
  EXPECT_THAT(bench.status.back().reason, HasSubstr("stop button"));
  bench.base.inputs.stop_button = false;
  const double travel = bench.base.travel;
  bench.run(3.0);
  EXPECT_EQ(bench.base.travel, travel);
  bench.send_motors(1, true);
  bench.run(2.0);
  EXPECT_GT(bench.base.travel, travel);
}

TEST(P3dxNode, ReportsAStallAndTheBumpers) {
  P3dxBench bench;
  bench.drive(0.3, 0.0);
  bench.run(3.0);
  bench.base.inputs.stall_left = true;
  bench.base.inputs.bumpers_front = 2;
  bench.run(0.3);
  EXPECT_TRUE(bench.status.back().stall_left);
  EXPECT_EQ(bench.status.back().bumpers_front, 2);
  EXPECT_THAT(bench.status.back().reason, HasSubstr("left wheel"));
}

TEST(P3dxNode, TurnsFinerThanTheProtocolKnows) {
  P3dxBench bench;
  bench.run(2.0);
  constexpr double kRate = radians(3.3);
  bench.drive(0.0, kRate);
  bench.run(2.0);
  const double begin = bench.base.turned;
  bench.run(20.0);
  EXPECT_NEAR(bench.base.turned - begin, 20.0 * kRate, radians(0.2));
}

TEST(P3dxNode, MeasuresExactlyOverManyWrapsOfTheRegisters) {
  ArcosConfig arcos;
  arcos.flash.velocity_top = 1500;
  P3dxConfig config = P3dxBench::robot_config();
  config.robot.limits.linear = 1.2;
  for (const double speed : {1.2, -1.2}) {
    P3dxBench bench(arcos, config);
    bench.run(2.0);
    bench.drive(speed, 0.0);
    bench.run(50.0 * 32.768 / 1.2);
    bench.driving = false;
    bench.run(3.0);
    EXPECT_GT(bench.base.travel, 50.0 * 32.768 - 2.0);
    EXPECT_NEAR(std::abs(bench.odometry.back().x), bench.base.travel, 0.001);
    EXPECT_EQ(bench.odometry.back().session, bench.odometry.front().session);
  }
}

TEST(P3dxNode, CountsEachSensorMessageWithinItsSession) {
  P3dxBench bench;
  bench.run(20.0);
  for (std::size_t i = 1; i < bench.odometry.size(); ++i) {
    EXPECT_EQ(bench.odometry[i].sequence, bench.odometry[i - 1].sequence + 1);
    EXPECT_EQ(bench.odometry[i].utime - bench.odometry[i - 1].utime, 100'000);
    EXPECT_EQ(bench.odometry[i].session, bench.sonar[i].session);
  }
  std::array<int, 16> fresh{};
  for (const sonar_t& message : bench.sonar) {
    for (std::size_t i = 0; i < fresh.size(); ++i) {
      fresh[i] += message.fresh[i];
      if (message.fresh[i] != 0) {
        EXPECT_NEAR(message.range[i], 1.0 + 0.1 * static_cast<double>(i), 1e-3);
        EXPECT_TRUE(message.has_echo[i]);
        EXPECT_GT(message.range_utime[i], message.utime - 200'000);
      }
    }
  }
  for (const int count : fresh) {
    EXPECT_GT(count, 50);  // each disc three times a second
    EXPECT_LT(count, 70);
  }
}

TEST(P3dxNode, TellsTheRobotToStandBeforeItsMotorsComeOn) {
  P3dxBench bench;
  bench.drive(0.3, 0.0);
  bench.run(2.0);
  const auto enable =
      std::find(bench.base.heard.begin(), bench.base.heard.end(), encode_command(ArcosCommand::kEnable, 1));
  ASSERT_NE(enable, bench.base.heard.end());
  ASSERT_GE(enable - bench.base.heard.begin(), 2);
  EXPECT_EQ(*(enable - 2), encode_command(ArcosCommand::kVelocity, 0));
  EXPECT_EQ(*(enable - 1), encode_command(ArcosCommand::kTurnRate, 0));
  const auto moving =
      std::find(bench.base.heard.begin(), bench.base.heard.end(), encode_command(ArcosCommand::kVelocity, 300));
  EXPECT_GT(moving - enable, 0);
}

TEST(P3dxNode, StopsAtOnceHoweverShortAgoTheLastCommandWas) {
  P3dxBench bench;
  bench.run(2.0);
  bench.drive(0.3, 0.2);
  bench.run(1.0);
  bench.driving = false;
  bench.send_command(bench.clock.utime(), bench.clock.utime(), 1, 0.4);
  bench.lcm.handleTimeout(0);
  bench.hear();
  bench.base.heard.clear();
  bench.send_stop(1, true);
  bench.lcm.handleTimeout(0);  // no time goes by
  bench.hear();
  ASSERT_FALSE(bench.base.heard.empty());
  EXPECT_EQ(bench.base.heard.back(), encode_command(ArcosCommand::kTurnRate, 0));
}

TEST(P3dxNode, StopsBeforeItKeepsTheStopOnDisk) {
  const TemporaryFolder folder;
  P3dxConfig config = P3dxBench::robot_config();
  config.state_folder = folder.path();
  std::vector<bool> kept;
  {
    P3dxBench bench({}, config);
    bench.drive(0.3, 0.0);
    bench.run(3.0);
    bench.noise.on_frame = [&](const PacketView& frame) {
      if (frame.type == static_cast<std::uint8_t>(ArcosCommand::kVelocity)) {
        kept.push_back(std::filesystem::exists(folder.path() / "stop"));
      }
    };
    bench.send_stop(1, true);
    bench.lcm.handleTimeout(0);  // no time goes by
  }
  EXPECT_EQ(kept, std::vector<bool>{false});
  EXPECT_TRUE(StopLatch(folder.path()).engaged());
}

TEST(P3dxNode, StandsAndSaysSoWhereTheKeptStopCannotBeRead) {
  const TemporaryFolder folder;
  folder.write("stop", "");  // as a power cut leaves it
  P3dxConfig config = P3dxBench::robot_config();
  config.state_folder = folder.path();
  P3dxBench bench({}, config);
  bench.drive(0.3, 0.0);
  bench.run(3.0);
  EXPECT_EQ(bench.base.travel, 0.0);
  EXPECT_THAT(bench.status.back().reason, HasSubstr("cannot read the stop that was kept"));
  bench.send_stop(1, false);
  bench.run(2.0);
  EXPECT_GT(bench.base.travel, 0.0);
}

TEST(P3dxNode, IsDegradedWhileTheStopCannotBeKept) {
  P3dxConfig config = P3dxBench::robot_config();
  config.state_folder = "/proc/nowhere";
  P3dxBench bench({}, config);
  bench.run(3.0);
  bench.send_stop(1, true);
  bench.lcm.handleTimeout(0);
  for (int i = 0; i < 1000 && bench.node.health().reason.find("survive") == std::string::npos; ++i) {
    bench.run(0.02);
    poll(nullptr, 0, 1);  // it is written beside this thread
  }
  EXPECT_TRUE(bench.node.health().degraded);
  EXPECT_THAT(bench.node.health().reason, HasSubstr("the stop would not survive a restart"));
}

TEST(P3dxNode, IsNotSwitchedByLateCopiesOfAnOlderRequest) {
  P3dxBench bench;
  bench.run(2.0);
  bench.send_motors(5, true);
  bench.send_motors(6, false);
  bench.send_motors(5, true);
  bench.run(2.0);
  EXPECT_FALSE(bench.base.outputs.motors_enabled);
  EXPECT_EQ(bench.status.back().motors_command_id, 6);
}

TEST(P3dxNode, SaysWhenTheRobotIsNotWhatItsFileSays) {
  ArcosConfig arcos;
  arcos.flash.velocity_top = 400;
  P3dxBench slow(arcos);
  slow.drive(0.5, 0.0);
  slow.run(4.0);
  EXPECT_THAT(slow.node.health().reason, HasSubstr("allows 0.50 m/s, the robot itself 0.40 m/s"));
  EXPECT_NEAR(slow.status.back().maximum_linear, 0.4, 1e-9);
  EXPECT_NEAR(slow.base.outputs.linear, 0.4, 1e-9);
  arcos = ArcosConfig();
  arcos.flash.has_rear_sonar = 0;
  P3dxBench half(arcos);
  half.run(4.0);
  EXPECT_THAT(half.node.health().reason, HasSubstr("no rear sonars"));
  for (std::size_t i = 8; i < 16; ++i) {
    EXPECT_EQ(half.sonar.back().range_utime[i], 0);
    EXPECT_FALSE(half.sonar.back().has_echo[i]);
  }
  P3dxBench good;
  good.run(4.0);
  EXPECT_EQ(good.node.health().reason, "");
  EXPECT_FALSE(good.node.health().degraded);
}

TEST(P3dxNode, DrivesARobotWithTheHabitsOfMobileSim) {
  ArcosConfig arcos;
  arcos.mobilesim = true;
  P3dxBench bench(arcos);
  bench.drive(0.3, 0.1);
  bench.run(12.0);
  EXPECT_NEAR(bench.base.outputs.linear, 0.3, 1e-9);
  EXPECT_EQ(std::count(bench.sonar.back().fresh.begin(), bench.sonar.back().fresh.end(), 1), 16);
  EXPECT_NEAR(bench.odometry.back().theta, wrap_angle(bench.base.turned), radians(1.5));
}

TEST(P3dxNode, SwitchesOffMotorsThatAreOnUnasked) {
  ArcosConfig arcos;
  arcos.mobilesim = true;
  P3dxConfig config = P3dxBench::robot_config();
  config.enable_motors_at_start = false;
  P3dxBench bench(arcos, config);
  bench.run(3.0);
  EXPECT_FALSE(bench.base.outputs.motors_enabled);
}

TEST(P3dxNode, LeavesTheRobotAtRestAndTheSessionClosed) {
  P3dxBench bench;
  bench.drive(0.4, 0.0);
  bench.run(4.0);
  int steps = 0;
  while (!bench.node.stand_still() && steps < 200) {
    bench.run(0.01);
    ++steps;
  }
  EXPECT_LT(steps, 100);
  bench.node.shut_down();
  bench.run(1.0);
  EXPECT_TRUE(bench.standing());
  EXPECT_FALSE(bench.base.outputs.motors_enabled);
  EXPECT_FALSE(bench.base.controller().session_open());
}

TEST(P3dxNode, DoesTheSameEachTime) {
  const auto record = [] {
    P3dxBench bench;
    bench.noise.byte_errors = 0.005;
    bench.drive(0.3, 0.2);
    bench.run(20.0);
    std::vector<double> values;
    for (const odometry_t& message : bench.odometry) {
      values.insert(values.end(), {message.x, message.y, message.theta, static_cast<double>(message.utime)});
    }
    return values;
  };
  EXPECT_EQ(record(), record());
}

TEST(P3dxNode, TakesThePowerOffAWheelWhoseEncoderIsDead) {
  P3dxBench bench;
  bench.run(3.0);
  bench.drive(0.4, 0.0);
  bench.run(2.0);
  ASSERT_FALSE(bench.node.health().fault);
  bench.base.dead_left = true;
  bench.run(1.9);
  EXPECT_TRUE(bench.node.health().fault);
  EXPECT_EQ(
      bench.node.health().reason,
      "the left wheel is told to turn and its encoder does not count it: motors off until they are requested again");
  EXPECT_EQ(bench.status.back().reason, bench.node.health().reason);
  EXPECT_FALSE(bench.status.back().motors_enabled);
  const double then = bench.base.true_left;
  bench.run(10.0);
  EXPECT_NEAR(bench.base.true_left, then, 1e-6);
  bench.base.dead_left = false;
  bench.send_motors(7, true);
  bench.run(3.0);
  EXPECT_FALSE(bench.node.health().fault) << bench.node.health().reason;
  EXPECT_GT(bench.base.true_left, then + 0.5);
}

TEST(P3dxNode, TakesThePowerOffAWheelThatRunsUntold) {
  P3dxBench bench;
  bench.run(3.0);
  bench.base.runaway_left = 0.3;
  bench.run(1.9);
  EXPECT_EQ(bench.node.health().reason,
            "the left wheel turns although it is told to stand: motors off until they are requested again");
  EXPECT_FALSE(bench.base.outputs.motors_enabled);
}

}  // namespace
}  // namespace luminav
