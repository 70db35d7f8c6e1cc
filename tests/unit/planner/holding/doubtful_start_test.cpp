#include "services/planner/holding/doubtful_start.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

constexpr std::int64_t kSecond = 1'000'000;  // [us]

TEST(DoubtfulStart, StandsStillThenLooksRoundByThirdsOfATurn) {
  DoubtfulStart doubt(10);
  ASSERT_TRUE(doubt.begin(0));
  EXPECT_FALSE(doubt.look_round({1.0, 2.0, 3.0}, 3 * kSecond));
  const auto turn = doubt.look_round({1.0, 2.0, 3.0}, 4 * kSecond);
  ASSERT_TRUE(turn);
  EXPECT_EQ(turn->points, (Polyline{{1.0, 2.0}}));
  EXPECT_NEAR(*turn->theta, wrap_angle(3.0 + 2.0 * kPi / 3.0), 1e-12);
  EXPECT_FALSE(doubt.look_round({1.0, 2.0, 3.0}, 5 * kSecond));
  EXPECT_TRUE(doubt.look_round({1.0, 2.0, 3.0}, 8 * kSecond));
}

TEST(DoubtfulStart, EndsAfter25SecondsInWhichTheRobotMightMove) {
  DoubtfulStart doubt(10);
  ASSERT_TRUE(doubt.begin(0));
  EXPECT_FALSE(doubt.is_over(24 * kSecond));
  doubt.begin_anew(24 * kSecond);  // the motors are off
  EXPECT_FALSE(doubt.is_over(48 * kSecond));
  EXPECT_TRUE(doubt.is_over(49 * kSecond));
}

TEST(DoubtfulStart, DoubtsOnlySoOftenOnTheWayToAStop) {
  DoubtfulStart doubt(1);
  EXPECT_TRUE(doubt.begin(0));
  EXPECT_FALSE(doubt.begin(0));
  doubt.reset();
  EXPECT_TRUE(doubt.begin(0));
}

}  // namespace
}  // namespace luminav
