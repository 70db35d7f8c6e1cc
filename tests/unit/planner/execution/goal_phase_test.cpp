#include "services/planner/execution/goal_phase.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

using enum GoalPhase;

TEST(GoalPhase, EveryPhaseMayEndOrLoseThePose) {
  for (const GoalPhase phase : {kLocalizing, kPlanning, kSuspectingPlace, kFollowing, kHolding, kDwelling, kRetrying}) {
    EXPECT_TRUE(may_follow(phase, kNone));
    EXPECT_TRUE(may_follow(phase, kLocalizing));
    EXPECT_TRUE(may_follow(phase, kPaused));
  }
}

TEST(GoalPhase, NothingDrivesBeforeThePoseIsKnownAndAPathIsPlanned) {
  for (const GoalPhase phase : {kNone, kPaused, kLocalizing}) {
    EXPECT_FALSE(may_follow(phase, kFollowing));
    EXPECT_FALSE(may_follow(phase, kHolding));
  }
  EXPECT_TRUE(may_follow(kLocalizing, kPlanning));
  EXPECT_TRUE(may_follow(kPlanning, kFollowing));
}

TEST(GoalPhase, APausedGoalGoesOnByFindingItsPlace) {
  EXPECT_TRUE(may_follow(kPaused, kLocalizing));
  EXPECT_FALSE(may_follow(kPaused, kPlanning));
  EXPECT_FALSE(may_follow(kNone, kPaused));
}

}  // namespace
}  // namespace luminav
