#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "drivers/base/safety/velocity_gate.hpp"
#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/velocity_writer.hpp"
#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kNow = 1'000'000'000;  // [us]

VelocityGate::Offer offer(std::int64_t utime, std::int32_t sequence, double linear = 0.2) {
  return {.utime = utime, .session = kNow - 1'000'000, .sequence = sequence, .linear = linear};
}

TEST(VelocityGate, ObeysAFreshCommandForItsLifetime) {
  VelocityGate gate({});
  EXPECT_EQ(gate.offer(offer(kNow, 1), kNow), "");
  EXPECT_DOUBLE_EQ(gate.velocity(kNow + 300'000).linear, 0.2);
  EXPECT_DOUBLE_EQ(gate.velocity(kNow + 300'001).linear, 0.0);
  EXPECT_FALSE(gate.is_fresh(kNow + 300'001));
}

TEST(VelocityGate, RefusesABacklog) {
  VelocityGate gate({});
  for (int i = 0; i < 100; ++i) {
    EXPECT_NE(gate.offer(offer(kNow - 1'000'000 + 1'000 * i, i), kNow), "");
  }
  EXPECT_EQ(gate.refused(), 100);
  EXPECT_DOUBLE_EQ(gate.velocity(kNow).linear, 0.0);
}

TEST(VelocityGate, RefusesRepeatedAndOvertakenCommands) {
  VelocityGate gate({});
  EXPECT_EQ(gate.offer(offer(kNow, 5), kNow), "");
  EXPECT_NE(gate.offer(offer(kNow, 5), kNow), "");
  EXPECT_NE(gate.offer(offer(kNow, 4), kNow), "");
  EXPECT_EQ(gate.offer(offer(kNow, 6), kNow), "");
}

TEST(VelocityGate, ForgetsASessionThatIsSilentForASecond) {
  VelocityGate gate({});
  VelocityGate::Offer recorded = offer(kNow, 100);
  recorded.session = kNow;  // later than that of the controller that runs
  EXPECT_EQ(gate.offer(recorded, kNow), "");
  EXPECT_NE(gate.offer(offer(kNow + 1'000'000, 1), kNow + 1'000'000), "");
  EXPECT_EQ(gate.offer(offer(kNow + 1'000'001, 2), kNow + 1'000'001), "");
}

TEST(VelocityGate, FollowsANewSenderAndNoLongerTheOld) {
  VelocityGate gate({});
  VelocityGate::Offer old_sender = offer(kNow, 100);
  VelocityGate::Offer new_sender = offer(kNow, 1, 0.1);
  new_sender.session = kNow;
  EXPECT_EQ(gate.offer(old_sender, kNow), "");
  EXPECT_EQ(gate.offer(new_sender, kNow), "");
  old_sender.sequence = 101;
  EXPECT_NE(gate.offer(old_sender, kNow), "");
  EXPECT_DOUBLE_EQ(gate.velocity(kNow).linear, 0.1);
}

TEST(VelocityGate, RefusesWhatMakesNoSense) {
  VelocityGate gate({});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(gate.offer(offer(kNow, 1, nan), kNow), "");
  EXPECT_NE(gate.offer(offer(kNow, 2, std::numeric_limits<double>::infinity()), kNow), "");
  VelocityGate::Offer sideways = offer(kNow, 3);
  sideways.sideways = 0.1;
  EXPECT_NE(gate.offer(sideways, kNow), "");
  EXPECT_NE(gate.offer(offer(kNow + 60'000'000, 4), kNow), "");
  VelocityGate::Offer future_session = offer(kNow, 5);
  future_session.session = std::numeric_limits<std::int64_t>::max();
  EXPECT_NE(gate.offer(future_session, kNow), "");
  EXPECT_EQ(gate.offer(offer(kNow, 6), kNow), "");  // and none of them shuts the gate
}

TEST(VelocityGate, KeepsTheArcWhenItLimits) {
  VelocityGate gate({.maximum_linear = 0.15, .maximum_angular = 1.0});
  VelocityGate::Offer wide = offer(kNow, 1, 0.5);
  wide.angular = 0.5;
  EXPECT_EQ(gate.offer(wide, kNow), "");
  EXPECT_DOUBLE_EQ(gate.velocity(kNow).linear, 0.15);
  EXPECT_DOUBLE_EQ(gate.velocity(kNow).angular, 0.15);
  VelocityGate::Offer tight = offer(kNow, 2, -0.1);
  tight.angular = -4.0;
  EXPECT_EQ(gate.offer(tight, kNow), "");
  EXPECT_DOUBLE_EQ(gate.velocity(kNow).linear, -0.025);
  EXPECT_DOUBLE_EQ(gate.velocity(kNow).angular, -1.0);
}

TEST(VelocityGate, ClampsToTheLimits) {
  VelocityGate gate({.maximum_linear = 0.5, .maximum_angular = 1.0});
  VelocityGate::Offer fast = offer(kNow, 1, -9.0);
  fast.angular = 9.0;
  EXPECT_EQ(gate.offer(fast, kNow), "");
  EXPECT_DOUBLE_EQ(gate.velocity(kNow).linear, -0.5);
  EXPECT_DOUBLE_EQ(gate.velocity(kNow).angular, 0.5);
}

TEST(VelocityGate, WantsANewCommandAfterItWasCleared) {
  VelocityGate gate({});
  gate.offer(offer(kNow, 1), kNow);
  gate.clear(kNow + 100'000);
  EXPECT_FALSE(gate.is_fresh(kNow + 100'000));
  EXPECT_NE(gate.offer(offer(kNow + 50'000, 2), kNow + 150'000), "");  // answers something from before
  EXPECT_EQ(gate.offer(offer(kNow + 120'000, 3), kNow + 150'000), "");
}

/// Follows the frames as a robot would, with an immediate turn rate.
struct Follower {
  void take(const std::vector<std::vector<std::uint8_t>>& frames) {
    PacketParser parser;
    for (const auto& frame : frames) {
      parser.push(frame);
      const auto packet = parser.next();
      const int value = decode_argument(packet->payload).value;
      const bool turns = packet->type == static_cast<std::uint8_t>(ArcosCommand::kTurnRate);
      (turns ? turn_rate : velocity) = value;
      ++count;
    }
  }
  int velocity = -1;
  int turn_rate = -1;
  int count = 0;
};

TEST(VelocityWriter, BeginsWithBothAxes) {
  VelocityWriter writer;
  Follower robot;
  robot.take(writer.poll({}, kNow));
  EXPECT_EQ(robot.count, 2);
  EXPECT_EQ(robot.velocity, 0);
  EXPECT_EQ(robot.turn_rate, 0);
}

TEST(VelocityWriter, SendsAChangeAtOnceAndRepeatsItLater) {
  VelocityWriter writer;
  Follower robot;
  robot.take(writer.poll({}, kNow));
  robot.take(writer.poll({0.3, 0.0}, kNow + 20'000));
  EXPECT_EQ(robot.velocity, 300);
  EXPECT_EQ(robot.count, 3);
  for (int i = 3; i <= 102; ++i) {
    robot.take(writer.poll({0.3, 0.0}, kNow + 10'000 * i));
  }
  EXPECT_NEAR(robot.count, 3 + 20, 3);  // both every 0.1 s: a lost one is made good
}

TEST(VelocityWriter, DoesNotKeepAChangeWaitingBehindARepetition) {
  VelocityWriter writer;
  Follower robot;
  robot.take(writer.poll({0.3, 0.0}, kNow));
  robot.take(writer.poll({0.3, 0.0}, kNow + 100'000));  // said again
  EXPECT_EQ(robot.count, 4);
  robot.take(writer.poll({0.1, 0.0}, kNow + 101'000));
  EXPECT_EQ(robot.velocity, 100);
}

TEST(VelocityWriter, SendsChangesThatArriveUnevenlyButNotMoreThanTheLineTakes) {
  VelocityWriter writer;
  Follower robot;
  robot.take(writer.poll({}, kNow));
  robot.take(writer.poll({0.1, 0.0}, kNow + 40'000));
  robot.take(writer.poll({0.2, 0.0}, kNow + 43'000));
  EXPECT_EQ(robot.velocity, 200);
  robot.take(writer.poll({0.3, 0.0}, kNow + 46'000));  // the third within 6 ms
  EXPECT_EQ(robot.velocity, 200);
  robot.take(writer.poll({0.3, 0.0}, kNow + 56'000));
  EXPECT_EQ(robot.velocity, 300);
  robot.count = 0;
  for (int i = 1; i <= 1000; ++i) {  // one each millisecond
    robot.take(writer.poll({0.0001 * i, 0.0}, kNow + 100'000 + 1'000 * i));
  }
  EXPECT_LE(robot.count, 67 + 1 + 10);  // VEL with each change that left, RVEL ten times a second
}

TEST(VelocityWriter, SendsTheSlowestCreepThatTheProtocolKnows) {
  VelocityWriter writer;
  Follower robot;
  robot.take(writer.poll({}, kNow));
  robot.take(writer.poll({0.001, 0.0}, kNow + 50'000));
  EXPECT_EQ(robot.velocity, 1);
  robot.take(writer.poll({-0.001, 0.0}, kNow + 100'000));
  EXPECT_EQ(robot.velocity, -1);
}

TEST(VelocityWriter, KeepsTheMeanTurnRateWithinATenthOfADegreePerSecond) {
  for (const double wanted_deg : {0.2, -0.2, 0.5, 1.37, -7.77, 12.05, 33.3}) {
    VelocityWriter writer;
    Follower robot;
    robot.take(writer.poll({0.1, radians(wanted_deg)}, kNow));
    double turned = 0.0;
    double turned_at_second = 0.0;
    for (int i = 1; i <= 1000; ++i) {  // steps of 10 ms
      robot.take(writer.poll({0.1, radians(wanted_deg)}, kNow + 10'000 * i));
      EXPECT_LE(std::abs(robot.turn_rate - wanted_deg), 1.0);
      turned += 0.01 * robot.turn_rate;
      if (i % 100 == 0) {
        EXPECT_NEAR(turned - turned_at_second, wanted_deg, 0.1) << wanted_deg << " second " << i / 100;
        turned_at_second = turned;
      }
    }
  }
}

TEST(VelocityWriter, KeepsTheMeanTurnRateWhenCommandsChangeAllTheTime) {
  VelocityWriter writer;
  Follower robot;
  writer.poll({}, kNow);
  double turned = 0.0;
  double wanted = 0.0;
  for (int i = 1; i <= 1000; ++i) {
    const double rate = 3.4 + 0.3 * std::sin(0.05 * i);
    robot.take(writer.poll({0.1, radians(rate)}, kNow + 10'000 * i));
    turned += 0.01 * robot.turn_rate;
    wanted += 0.01 * rate;
  }
  EXPECT_NEAR(turned, wanted, 0.2);
}

TEST(VelocityWriter, StandsExactlyWhenToldToStand) {
  VelocityWriter writer;
  Follower robot;
  writer.poll({}, kNow);
  robot.take(writer.poll({0.2, radians(0.7)}, kNow + 50'000));
  for (int i = 1; i < 50; ++i) {
    robot.take(writer.poll({}, kNow + 50'000 + 50'000 * i));
    EXPECT_EQ(robot.turn_rate, 0);
    EXPECT_EQ(robot.velocity, 0);
  }
}

}  // namespace
}  // namespace luminav
