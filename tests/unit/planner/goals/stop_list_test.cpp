#include "services/planner/goals/stop_list.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

using After = StopList::AfterFailure;

GoalRequest goal_of(int stops, FailurePolicy policy, bool loop = false) {
  GoalRequest goal;
  for (int i = 0; i < stops; ++i) {
    GoalStop stop;
    stop.pose = {1.0 * i, 0.0, 0.0};
    goal.stops.push_back(stop);
  }
  goal.policy = policy;
  goal.loop = loop;
  return goal;
}

StopList list_of(const GoalRequest& goal, int index = 0) {
  GoalParams params;
  params.retries = 2;
  StopList stops(params);
  stops.begin(goal, index);
  return stops;
}

TEST(StopList, EndsWithTheLastStopUnlessItLoops) {
  StopList once = list_of(goal_of(2, FailurePolicy::kStop));
  EXPECT_FALSE(once.is_last());
  once.next();
  EXPECT_TRUE(once.is_last());
  StopList loop = list_of(goal_of(2, FailurePolicy::kStop, true), 1);
  EXPECT_FALSE(loop.is_last());
  loop.next();
  EXPECT_EQ(loop.index(), 0);
}

TEST(StopList, BeginsAtAStopThatExists) {
  EXPECT_EQ(list_of(goal_of(2, FailurePolicy::kStop), 7).index(), 1);
  EXPECT_EQ(list_of(goal_of(2, FailurePolicy::kStop), -1).index(), 0);
}

TEST(StopList, RetriesAStopSoOftenAndThenGivesUp) {
  StopList stops = list_of(goal_of(2, FailurePolicy::kRetry));
  EXPECT_EQ(stops.failed(false), After::kTryAgain);
  EXPECT_EQ(stops.failed(false), After::kTryAgain);
  EXPECT_EQ(stops.failed(false), After::kGiveUp);
}

TEST(StopList, SkipsAStopButNotTheLastOneAndNotAllOfThem) {
  StopList stops = list_of(goal_of(3, FailurePolicy::kSkip));
  EXPECT_EQ(stops.failed(false), After::kGoOn);
  stops.next();
  EXPECT_EQ(stops.skipped(), 1);
  stops.next();
  EXPECT_EQ(stops.failed(false), After::kGiveUp);
  StopList loop = list_of(goal_of(2, FailurePolicy::kSkip, true));
  EXPECT_EQ(loop.failed(false), After::kGoOn);
  loop.next();
  loop.reached();
  EXPECT_EQ(loop.failed(false), After::kGoOn) << "one was reached in between";
  loop.next();
  EXPECT_EQ(loop.failed(false), After::kGiveUp);
}

TEST(StopList, GivesUpAtOnceWhereNoOtherStopWillFareBetter) {
  StopList stops = list_of(goal_of(3, FailurePolicy::kSkip));
  EXPECT_EQ(stops.failed(true), After::kGiveUp);
}

TEST(StopList, JudgesPlaceAndHeadingByTheGoalsOwnTolerances) {
  GoalRequest goal = goal_of(1, FailurePolicy::kStop);
  goal.stops.front().has_theta = true;
  goal.tolerance = 0.1;
  goal.heading_tolerance = 0.2;
  const StopList stops = list_of(goal);
  EXPECT_TRUE(stops.is_at_stop({0.09, 0.0, -0.19}));
  EXPECT_FALSE(stops.is_at_stop({0.11, 0.0, 0.0}));
  EXPECT_FALSE(stops.is_at_stop({0.0, 0.0, 0.21}));
  EXPECT_NEAR(stops.planned_tolerance(), 0.06, 1e-9) << "the controller may stop short of the path's end";
}

}  // namespace
}  // namespace luminav
