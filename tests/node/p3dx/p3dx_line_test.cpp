#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/node/p3dx/p3dx_bench.hpp"

namespace luminav {
namespace {

// What a bad line, a pause and a robot that begins anew do to the driver.

using testing::HasSubstr;

TEST(P3dxLine, SaysWhyThereIsNoRobot) {
  P3dxBench bench;
  bench.unplug();
  bench.run(3.0);
  ASSERT_FALSE(bench.status.empty());
  EXPECT_FALSE(bench.status.back().connected);
  EXPECT_EQ(bench.status.back().session, 0);
  EXPECT_THAT(bench.status.back().reason, HasSubstr("unplugged"));
  EXPECT_TRUE(bench.node.health().fault);
  EXPECT_TRUE(bench.odometry.empty());
}

TEST(P3dxLine, TakesOverASessionThatSomebodyLeftOpen) {
  P3dxBench bench;
  for (const std::uint8_t sync : {packet_type::kSync0, packet_type::kSync1, packet_type::kSync2}) {
    bench.base.controller().receive(encode_packet(sync));
  }
  bench.base.controller().receive(encode_command(ArcosCommand::kOpen));
  ASSERT_TRUE(bench.base.controller().session_open());
  bench.run(3.0);
  EXPECT_TRUE(bench.status.back().connected);
  EXPECT_TRUE(bench.status.back().motors_enabled);
}

TEST(P3dxLine, StandsStillBetweenFiftyCutsOfTheLineAndResumesOnFreshCommands) {
  P3dxBench bench;
  bench.drive(0.3, 0.0);
  std::int64_t last_session = 0;
  for (int i = 0; i < 50; ++i) {
    bench.run(4.0);
    ASSERT_TRUE(bench.status.back().connected) << i;
    ASSERT_NEAR(bench.base.outputs.linear, 0.3, 1e-9) << i;
    EXPECT_NE(bench.status.back().session, last_session);
    last_session = bench.status.back().session;
    bench.unplug();
    bench.run(2.0 + 0.3 / 1.0 + 0.1);  // the robot's watchdog: nobody else can reach it
    ASSERT_TRUE(bench.standing()) << i;
    ASSERT_FALSE(bench.status.back().connected) << i;
    bench.driving = false;
    bench.plug_in();
    bench.run(3.0);
    ASSERT_TRUE(bench.status.back().connected) << i;
    ASSERT_TRUE(bench.standing()) << i;  // nothing of the old motion is resumed
    bench.driving = true;
  }
}

TEST(P3dxLine, StandsStillAfterItsProcessHasSlept) {
  P3dxBench bench;
  bench.drive(0.3, 0.0);
  bench.run(4.0);
  for (const double seconds : {0.5, 1.9, 3.0, 10.0}) {
    bench.asleep = true;
    bench.driving = false;
    bench.run(seconds);
    bench.asleep = false;
    const double before = bench.base.travel;
    bench.run(3.0);
    EXPECT_TRUE(bench.standing()) << seconds;
    EXPECT_LT(bench.base.travel - before, 0.15) << seconds;  // at most the way of braking
    bench.driving = true;
    bench.run(4.0);
    EXPECT_NEAR(bench.base.outputs.linear, 0.3, 1e-9) << seconds;
  }
}

TEST(P3dxLine, BeginsAnewAtOnceWhenItsGuardianHasEndedTheSession) {
  P3dxConfig config = P3dxBench::robot_config();
  config.guardian_done_after = 1.25;
  P3dxBench bench({}, config);
  bench.drive(0.3, 0.0);
  bench.run(4.0);
  const std::int64_t session = bench.status.back().session;
  bench.asleep = true;
  bench.run(1.25);
  bench.base.controller().receive(encode_command(ArcosCommand::kClose));  // the guardian's last word
  bench.asleep = false;
  bench.run(1.5);  // the robot's silence alone tells after 2.5 s
  EXPECT_TRUE(bench.status.back().connected);
  EXPECT_NE(bench.status.back().session, session);
  EXPECT_NEAR(bench.base.outputs.linear, 0.3, 1e-9);
}

TEST(P3dxLine, LeavesTheLineToItsGuardianUntilThatIsDone) {
  P3dxConfig config = P3dxBench::robot_config();
  config.guardian_done_after = 1.25;
  P3dxBench bench({}, config);
  bench.run(4.0);
  bench.asleep = true;
  bench.run(0.4);
  bench.asleep = false;
  bench.run(0.8);
  EXPECT_FALSE(bench.status.back().connected);
  bench.run(1.5);
  EXPECT_TRUE(bench.status.back().connected);
}

TEST(P3dxLine, LeavesTheLineExactlyWhenItsGuardianHasActed) {
  P3dxConfig config = P3dxBench::robot_config();
  config.guardian_done_after = 1.25;
  int acted = 0;
  int tries = 0;
  for (const double gap : {0.24, 0.27, 0.31}) {
    for (int phase = 0; phase < 6; ++phase) {  // a beat comes with every sixth step
      P3dxBench bench({}, config);
      bench.drive(0.3, 0.1);
      bench.run(4.0 + 0.01 * phase);
      bench.asleep = true;
      bench.run(gap);
      // A command from just before, which by its age alone would still be obeyed, waits as the process wakes.
      bench.driving = false;
      bench.base.heard.clear();
      bench.clock.advance(10'000);
      const bool guardian_acted = bench.clock.utime() - bench.last_beat >= 300'000;
      bench.send_command(bench.clock.utime() - 100'000, bench.clock.utime(), 1, 0.4);
      bench.lcm.handleTimeout(0);
      bench.node.poll();
      bench.asleep = false;
      bench.run(0.5);
      EXPECT_EQ(bench.status.back().connected == 0, guardian_acted) << gap << ", " << phase;
      if (guardian_acted) {
        EXPECT_THAT(bench.base.heard, testing::ElementsAre(encode_command(ArcosCommand::kVelocity, 0),
                                                           encode_command(ArcosCommand::kTurnRate, 0)))
            << gap << ", " << phase;
      }
      acted += guardian_acted ? 1 : 0;
      ++tries;
    }
  }
  EXPECT_GE(acted, 6);
  EXPECT_LE(acted, tries - 6);
}

TEST(P3dxLine, BeginsAnewWhenItWasHeldUpBetweenAPollAndItsBeat) {
  P3dxConfig config = P3dxBench::robot_config();
  config.guardian_done_after = 1.25;
  P3dxBench bench({}, config);
  bench.drive(0.3, 0.0);
  bench.run(4.0);
  bool slow = true;
  bench.node.report_life([&] {
    bench.clock.advance(slow ? 310'000 : 0);
    slow = false;
  });
  bench.run(0.5);
  EXPECT_FALSE(slow);
  EXPECT_FALSE(bench.status.back().connected);
  bench.run(2.0);
  EXPECT_TRUE(bench.status.back().connected);
}

TEST(P3dxLine, TellsTheRobotToStandBeforeAnythingElseAfterAGap) {
  P3dxBench bench;
  bench.drive(0.3, 0.1);
  bench.run(4.0);
  for (const double seconds : {0.5, 1.0, 2.2}) {
    bench.asleep = true;
    bench.driving = false;
    bench.run(seconds);
    bench.asleep = false;
    bench.base.heard.clear();
    bench.run(0.5);
    ASSERT_GE(bench.base.heard.size(), 2U) << seconds;
    EXPECT_EQ(bench.base.heard[0], encode_command(ArcosCommand::kVelocity, 0)) << seconds;
    EXPECT_EQ(bench.base.heard[1], encode_command(ArcosCommand::kTurnRate, 0)) << seconds;
    bench.driving = true;
    bench.run(4.0);
  }
}

TEST(P3dxLine, MeasuresThroughALineThatDamagesOneByteInAHundred) {
  P3dxBench bench;
  bench.run(2.0);
  bench.noise.byte_errors = 0.01;
  bench.drive(0.3, 0.1);
  double fastest = 0.0;
  double fastest_turn = 0.0;
  for (int i = 0; i < 6000; ++i) {  // ten minutes
    bench.run(0.1);
    fastest = std::max(fastest, std::abs(bench.base.outputs.linear));
    fastest_turn = std::max(fastest_turn, std::abs(bench.base.outputs.angular));
  }
  bench.noise.byte_errors = 0.0;
  bench.driving = false;
  bench.run(3.0);
  // Never a command that was not sent.
  EXPECT_GT(bench.base.heard.size(), 10'000U);
  EXPECT_THAT(bench.base.heard, testing::Each(testing::Truly([&](const std::vector<std::uint8_t>& frame) {
                return bench.noise.sent.contains(frame);
              })));
  EXPECT_LE(fastest, 0.3 + 1e-9);
  EXPECT_LE(fastest_turn, radians(6.0) + 1e-9);
  EXPECT_GT(bench.base.travel, 150.0);
  EXPECT_GT(bench.status.back().bad_packets, 1000);
  // The robot drives circles: the sum of the steps is compared, and the heading.
  EXPECT_EQ(bench.odometry.front().session, bench.odometry.back().session);
  EXPECT_NEAR(wrap_angle(bench.odometry.back().theta - bench.base.turned), 0.0, 2.0 * kPi / 4096.0);
  double distance = 0.0;
  for (std::size_t i = 1; i < bench.odometry.size(); ++i) {
    distance +=
        std::hypot(bench.odometry[i].x - bench.odometry[i - 1].x, bench.odometry[i].y - bench.odometry[i - 1].y);
  }
  EXPECT_NEAR(distance, bench.base.travel, 0.01 * bench.base.travel);
}

TEST(P3dxLine, WorksOverALineThatTakesAndGivesAFewBytesAtATime) {
  P3dxBench bench;
  bench.noise.max_written = 4;  // less than the shortest frame
  bench.noise.max_read = 9;     // just more than the robot sends
  bench.drive(0.3, 0.0);
  bench.run(10.0);
  EXPECT_TRUE(bench.status.back().connected);
  EXPECT_EQ(bench.status.back().bad_packets, 0);
  EXPECT_EQ(bench.base.controller().bad_packets(), 0);
  EXPECT_NEAR(bench.base.outputs.linear, 0.3, 1e-9);
}

TEST(P3dxLine, SpreadsTheStampsOfPacketsThatWereHeldBack) {
  P3dxBench bench;
  bench.drive(0.3, 0.0);
  bench.run(4.0);
  bench.asleep = true;
  bench.run(0.75);
  bench.asleep = false;
  bench.run(1.0);
  for (std::size_t i = 1; i < bench.odometry.size(); ++i) {
    EXPECT_GE(bench.odometry[i].utime - bench.odometry[i - 1].utime, 50'000);
  }
}

TEST(P3dxLine, TakesTheRobotsOwnDelayOffTheStamps) {
  ArcosConfig arcos;
  arcos.flash.kinematics_delay = 55;  // [ms]
  P3dxBench late(arcos);
  P3dxBench prompt;
  late.run(4.0);
  prompt.run(4.0);
  ASSERT_EQ(late.odometry.size(), prompt.odometry.size());
  EXPECT_EQ(prompt.odometry.back().utime - late.odometry.back().utime, 55'000);
}

TEST(P3dxLine, SendsItsLimitsAgainUntilTheRobotHasThem) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    P3dxBench bench;
    bench.noise.rng.seed(seed);
    bench.noise.byte_errors = 0.01;  // of the commands one in eleven is lost, of the answers three in four
    bench.run(25.0);
    ASSERT_NE(bench.status.back().session, 0) << seed << ": " << bench.status.back().reason;
    EXPECT_NEAR(bench.status.back().deceleration, 1.0, 1e-9) << seed;
  }
}

TEST(P3dxLine, StartsANewSessionWhenTheRegistersAreReset) {
  P3dxBench bench;
  bench.drive(0.5, 0.0);
  bench.run(8.0);
  const std::int64_t session = bench.odometry.back().session;
  bench.base.controller().receive(encode_command(ArcosCommand::kSetOrigin));
  bench.run(2.0);
  EXPECT_NE(bench.odometry.back().session, session);
  EXPECT_GT(bench.status.back().impossible_packets, 0);
  for (std::size_t i = 1; i < bench.odometry.size(); ++i) {
    if (bench.odometry[i].session == bench.odometry[i - 1].session) {
      EXPECT_LT(std::abs(bench.odometry[i].x - bench.odometry[i - 1].x), 0.21);
    }
  }
}

TEST(P3dxLine, ConnectsAgainWhenTheRobotIsReset) {
  P3dxBench bench;
  bench.drive(0.3, 0.0);
  bench.run(4.0);
  bench.base.controller().receive(encode_command(ArcosCommand::kReset));
  bench.run(5.0);
  EXPECT_TRUE(bench.status.back().connected);
  EXPECT_NEAR(bench.base.outputs.linear, 0.3, 1e-9);
}

}  // namespace
}  // namespace luminav
