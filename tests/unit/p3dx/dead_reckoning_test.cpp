#include "drivers/p3dx/dead_reckoning.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace luminav {
namespace {

constexpr std::int64_t kCycle = 100'000;  // [us]
using Verdict = DeadReckoning::Verdict;

InformationPacket at(double x_mm, double y_mm, double heading_units) {
  InformationPacket packet;
  packet.x_mm = static_cast<std::int16_t>(std::llround(x_mm) & 0xFFFF);
  packet.y_mm = static_cast<std::int16_t>(std::llround(y_mm) & 0xFFFF);
  packet.heading = static_cast<int>(std::lround(std::remainder(heading_units, 4096.0)));
  return packet;
}

TEST(DeadReckoning, TakesTheFirstPacketAsTheReference) {
  DeadReckoning reckoning({});
  EXPECT_EQ(reckoning.update(at(-250, 1200, 1024), kCycle), Verdict::kAccepted);
  EXPECT_DOUBLE_EQ(reckoning.odom_from_robot().x, -0.25);
  EXPECT_DOUBLE_EQ(reckoning.odom_from_robot().y, 1.2);
  EXPECT_DOUBLE_EQ(reckoning.odom_from_robot().theta, 0.5 * kPi);
}

/// At 1.2 m/s over fifty wraps of 15 bits, whatever the width of the robot's registers.
double distance_over_wraps(double sign, int mask, bool sign_extended) {
  DeadReckoning reckoning({});
  const double end = sign * 50.0 * 32768.0;
  double x = 0.0;
  std::int64_t now = 0;
  reckoning.update(at(0, 0, 0), now);
  while (std::abs(x) < std::abs(end)) {
    x += sign * 120.0;
    now += kCycle;
    InformationPacket packet = at(x, 0, 0);
    packet.x_mm = packet.x_mm & mask;
    if (sign_extended) {
      packet.x_mm = static_cast<std::int16_t>(packet.x_mm);
    }
    EXPECT_EQ(reckoning.update(packet, now), Verdict::kAccepted);
  }
  return reckoning.odom_from_robot().x - 1e-3 * x;
}

TEST(DeadReckoning, IsExactOverFiftyWrapsInBothDirections) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_DOUBLE_EQ(distance_over_wraps(sign, 0xFFFF, true), 0.0);
    EXPECT_DOUBLE_EQ(distance_over_wraps(sign, 0x7FFF, false), 0.0);
  }
}

TEST(DeadReckoning, UnwrapsTheHeading) {
  DeadReckoning reckoning({});
  for (int i = 0; i <= 300; ++i) {
    ASSERT_EQ(reckoning.update(at(0, 0, 100.0 * i), i * kCycle), Verdict::kAccepted);
  }
  EXPECT_NEAR(reckoning.odom_from_robot().theta, wrap_angle(30000.0 * 2.0 * kPi / 4096.0), 1e-9);
}

TEST(DeadReckoning, LosesNoDistanceWhenPacketsAreMissing) {
  DeadReckoning reckoning({});
  reckoning.update(at(0, 0, 0), 0);
  EXPECT_EQ(reckoning.update(at(600, 0, 0), 5 * kCycle), Verdict::kAccepted);  // four were lost at 1.2 m/s
  EXPECT_DOUBLE_EQ(reckoning.odom_from_robot().x, 0.6);
}

TEST(DeadReckoning, RefusesAStepThatIsImpossibleAndGoesOn) {
  DeadReckoning reckoning({});
  reckoning.update(at(0, 0, 0), 0);
  reckoning.update(at(50, 0, 0), kCycle);
  EXPECT_EQ(reckoning.update(at(5000, 0, 0), 2 * kCycle), Verdict::kRefused);
  EXPECT_EQ(reckoning.update(at(150, 0, 2000), 3 * kCycle), Verdict::kRefused);
  EXPECT_EQ(reckoning.update(at(200, 0, 0), 4 * kCycle), Verdict::kAccepted);
  EXPECT_DOUBLE_EQ(reckoning.odom_from_robot().x, 0.2);
}

TEST(DeadReckoning, RefusesImpossibleWheelSpeeds) {
  DeadReckoning reckoning({});
  reckoning.update(at(0, 0, 0), 0);
  InformationPacket packet = at(10, 0, 0);
  packet.left_mm_s = 20000;
  EXPECT_EQ(reckoning.update(packet, kCycle), Verdict::kRefused);
}

TEST(DeadReckoning, AcceptsANewPlaceOnceSeveralPacketsAgree) {
  DeadReckoning reckoning({});
  reckoning.update(at(10000, 0, 0), 0);
  EXPECT_EQ(reckoning.update(at(0, 0, 0), kCycle), Verdict::kRefused);  // the registers were set to the origin
  EXPECT_EQ(reckoning.update(at(0, 0, 0), 2 * kCycle), Verdict::kRefused);
  EXPECT_EQ(reckoning.update(at(5, 0, 0), 3 * kCycle), Verdict::kJumped);
  EXPECT_DOUBLE_EQ(reckoning.odom_from_robot().x, 0.005);
  EXPECT_EQ(reckoning.update(at(15, 0, 0), 4 * kCycle), Verdict::kAccepted);
}

TEST(DeadReckoning, TakesPacketsThatWereHeldBackAndArriveTogether) {
  DeadReckoning reckoning({});
  reckoning.update(at(0, 0, 0), 0);
  for (int i = 1; i <= 5; ++i) {
    EXPECT_EQ(reckoning.update(at(100.0 * i, 0, 0), 5 * kCycle + i), Verdict::kAccepted);
  }
  EXPECT_DOUBLE_EQ(reckoning.odom_from_robot().x, 0.5);
}

TEST(DeadReckoning, ScalesTheUnitsOfOlderBoards) {
  DeadReckoning reckoning({.distance_factor = 0.485});
  reckoning.update(at(0, 0, 0), 0);
  reckoning.update(at(200, 100, 0), kCycle);
  EXPECT_NEAR(reckoning.odom_from_robot().x, 0.097, 1e-12);
  EXPECT_NEAR(reckoning.odom_from_robot().y, 0.0485, 1e-12);
}

TEST(DeadReckoning, TakesTheTurnRateFromTheWheelsWhereNoneIsSent) {
  DeadReckoning reckoning({});
  InformationPacket packet = at(0, 0, 0);
  packet.left_mm_s = -100;
  packet.right_mm_s = 300;
  reckoning.update(packet, 0);
  EXPECT_DOUBLE_EQ(reckoning.linear(), 0.1);
  EXPECT_DOUBLE_EQ(reckoning.angular(), 200 * 0.0056);
  packet.turn_rate = 100;
  reckoning.update(packet, kCycle);
  EXPECT_DOUBLE_EQ(reckoning.angular(), radians(10.0));
}

}  // namespace
}  // namespace luminav
