#include "services/controller/inputs/held_teleoperation.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace luminav {
namespace {

constexpr std::int64_t kNow = 1'000'000'000;  // [us]

teleop_command_t command(std::int32_t sequence, std::int64_t utime = kNow) {
  teleop_command_t message{};
  message.utime = utime;
  message.session = 7;
  message.sequence = sequence;
  message.linear = 0.3;
  message.angular = -0.2;
  return message;
}

TEST(HeldTeleoperation, HoldsACommandForThreeTenthsOfASecondAndPausesForOne) {
  HeldTeleoperation held;
  EXPECT_FALSE(held.is_steered(kNow));
  ASSERT_TRUE(held.take(command(1), kNow));
  ASSERT_TRUE(held.at(kNow + 300'000));
  EXPECT_EQ(held.at(kNow + 300'000)->linear, 0.3);
  EXPECT_EQ(held.at(kNow + 300'000)->angular, -0.2);
  EXPECT_FALSE(held.at(kNow + 300'001));
  EXPECT_TRUE(held.is_steered(kNow + 1'300'000));
  EXPECT_FALSE(held.is_steered(kNow + 1'300'001));
}

TEST(HeldTeleoperation, RefusesWhatIsRepeatedOrNotANumber) {
  HeldTeleoperation held;
  ASSERT_TRUE(held.take(command(2), kNow));
  EXPECT_FALSE(held.take(command(2, kNow + 100'000), kNow + 100'000));
  EXPECT_FALSE(held.take(command(1, kNow + 100'000), kNow + 100'000));
  EXPECT_FALSE(held.at(kNow + 350'000)) << "a repetition holds no longer";
  teleop_command_t broken = command(3);
  broken.angular = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(held.take(broken, kNow));
  teleop_command_t other = command(1, kNow + 400'000);
  other.session = 8;
  EXPECT_TRUE(held.take(other, kNow + 400'000)) << "another person counts anew";
}

TEST(HeldTeleoperation, IsNotSteeredByACommandOfAnotherTime) {
  for (const std::int64_t away : {-400'000, 400'000}) {
    HeldTeleoperation held;
    EXPECT_TRUE(held.take(command(1, kNow + away), kNow));
    EXPECT_FALSE(held.at(kNow));
    EXPECT_FALSE(held.is_steered(kNow));
  }
}

}  // namespace
}  // namespace luminav
