#include "services/launcher/deputy/respawn_policy.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace luminav::launcher {
namespace {

constexpr std::int64_t kShortLife = 1000;       // [us]
constexpr std::int64_t kLongLife = 11'000'000;  // [us]

TEST(RespawnPolicy, WaitsTwiceAsLongEachTimeAndThenGivesUp) {
  RespawnPolicy policy({.first_delay = 0.1, .longest_delay = 0.5, .settled_after = 10.0, .limit = 4});
  EXPECT_EQ(policy.delay_after(kShortLife), 100'000);
  EXPECT_EQ(policy.delay_after(kShortLife), 200'000);
  EXPECT_EQ(policy.delay_after(kShortLife), 400'000);
  EXPECT_EQ(policy.delay_after(kShortLife), 500'000);
  EXPECT_FALSE(policy.delay_after(kShortLife).has_value());
  EXPECT_FALSE(policy.delay_after(kShortLife).has_value());
}

TEST(RespawnPolicy, ForgivesAProcessThatHadRecovered) {
  RespawnPolicy policy({.first_delay = 0.1, .longest_delay = 5.0, .settled_after = 10.0, .limit = 2});
  EXPECT_EQ(policy.delay_after(kShortLife), 100'000);
  EXPECT_EQ(policy.delay_after(kShortLife), 200'000);
  EXPECT_EQ(policy.delay_after(kLongLife), 100'000);
  EXPECT_EQ(policy.deaths_in_a_row(), 1);
}

TEST(RespawnPolicy, BeginsAnewAfterAStartByOrder) {
  RespawnPolicy policy({.first_delay = 0.1, .longest_delay = 5.0, .settled_after = 10.0, .limit = 1});
  EXPECT_TRUE(policy.delay_after(kShortLife).has_value());
  EXPECT_FALSE(policy.delay_after(kShortLife).has_value());
  policy.reset();
  EXPECT_EQ(policy.delay_after(kShortLife), 100'000);
}

TEST(RespawnPolicy, IsBackWithinASecondAfterAFirstCrash) {
  RespawnPolicy policy{RespawnParams{}};
  EXPECT_LT(policy.delay_after(kLongLife).value(), 500'000);
}

TEST(RespawnPolicy, RefusesParametersThatMakeNoSense) {
  EXPECT_THROW(RespawnPolicy({.first_delay = 0.0}), std::invalid_argument);
  EXPECT_THROW(RespawnPolicy({.first_delay = 2.0, .longest_delay = 1.0}), std::invalid_argument);
  EXPECT_THROW(RespawnPolicy({.settled_after = -1.0}), std::invalid_argument);
  EXPECT_THROW(RespawnPolicy({.limit = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace luminav::launcher
