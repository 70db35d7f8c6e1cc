#include "services/planner/goals/suspected_obstacles.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(SuspectedObstacles, EachEndsAtATimeOfItsOwn) {
  SuspectedObstacles suspects;
  suspects.add({{1.0, 0.0}}, 100);
  suspects.add({{2.0, 0.0}}, 200);
  EXPECT_FALSE(suspects.expire(99));
  EXPECT_TRUE(suspects.expire(100));
  ASSERT_EQ(suspects.all().size(), 1U);
  EXPECT_EQ(suspects.all().front().centre.x(), 2.0);
  EXPECT_TRUE(suspects.expire(1000));
  EXPECT_TRUE(suspects.empty());
}

TEST(SuspectedObstacles, EndWhenTheClockStartsAnew) {
  SuspectedObstacles suspects;
  suspects.add({{1.0, 0.0}}, 1'000'000);
  suspects.restart_clock(7);
  EXPECT_FALSE(suspects.expire(6));
  EXPECT_TRUE(suspects.expire(7));
}

}  // namespace
}  // namespace luminav
