#include "services/planner/execution/goal_progress.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

constexpr std::int64_t kSecond = 1'000'000;  // [us]

Situation at(std::int64_t seconds) {
  Situation situation;
  situation.now = seconds * kSecond;
  return situation;
}

TEST(GoalProgress, StallsAfterAWhileWithoutComingNearer) {
  GoalProgress progress({});
  progress.begin_path(10.0, 0);
  EXPECT_FALSE(progress.has_stalled(9.9, at(5)));
  EXPECT_TRUE(progress.has_stalled(9.9, at(6))) << "a decimetre is none";
  EXPECT_FALSE(progress.has_stalled(9.7, at(6)));
  EXPECT_FALSE(progress.has_stalled(9.7, at(11)));
}

TEST(GoalProgress, IsMorePatientWhileTheControllerMovesAndLessWhenItIsStuck) {
  GoalProgress progress({});
  progress.begin_path(10.0, 0);
  Situation moving = at(17);
  moving.control = ControlReport{};
  EXPECT_FALSE(progress.has_stalled(10.0, moving));
  Situation stuck = at(2);
  stuck.control = ControlReport{};
  stuck.control->stuck = true;
  EXPECT_TRUE(progress.has_stalled(10.0, stuck));
}

TEST(GoalProgress, DoesNotCountWhileTheRobotMayNotMove) {
  GoalProgress progress({});
  progress.begin_path(10.0, 0);
  Situation stopped = at(60);
  stopped.can_move = false;
  EXPECT_FALSE(progress.has_stalled(10.0, stopped));
  EXPECT_FALSE(progress.has_stalled(10.0, at(65)));
}

TEST(GoalProgress, AnotherPathIsNoProgress) {
  GoalProgress progress({});
  progress.begin_path(10.0, 0);
  progress.replace_path(9.0);
  EXPECT_TRUE(progress.has_stalled(9.0, at(6)));
}

TEST(GoalProgress, IsStuckAfterPlansForAMinuteAndLaterAmongPeople) {
  GoalProgress progress({});
  progress.begin_path(10.0, 0);
  for (int i = 0; i < 6; ++i) {
    progress.count_attempt(i * kSecond);
  }
  EXPECT_FALSE(progress.is_stuck(false, 59 * kSecond));
  EXPECT_TRUE(progress.is_stuck(false, 60 * kSecond));
  EXPECT_FALSE(progress.is_stuck(true, 60 * kSecond));
  EXPECT_TRUE(progress.is_stuck(true, 180 * kSecond));
  EXPECT_FALSE(progress.has_stalled(8.9, at(60)));
  EXPECT_EQ(progress.attempts(), 0) << "a metre nearer, failures count from zero again";
}

TEST(GoalProgress, MissesAStopThreeTimesAtMost) {
  GoalProgress progress({});
  EXPECT_TRUE(progress.count_missed() && progress.count_missed() && progress.count_missed());
  EXPECT_FALSE(progress.count_missed());
}

}  // namespace
}  // namespace luminav
