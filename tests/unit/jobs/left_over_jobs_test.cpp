#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/jobs/pretended_robot.hpp"

namespace luminav {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Action = JobRequest::Action;

TEST(LeftOverJobs, GoOnAfterACrashWithTheGoalThatThePlannerHas) {
  PretendedRobot before;
  const std::int64_t job = before.add(JobKind::kGo, {"lab"});
  before.run(3.0);
  PretendedRobot robot;
  robot.navigation = before.navigation;
  robot.executor.load(before.executor.table());
  robot.run(3.0);
  EXPECT_THAT(robot.goals, IsEmpty()) << "the planner drives there already";
  robot.arrive();
  robot.run(1.0);
  EXPECT_EQ(robot.job(job).state, JobState::kDone);
}

TEST(LeftOverJobs, SendTheGoalThatNeverCameToThePlanner) {
  PretendedRobot before;
  before.is_deaf = true;
  const std::int64_t job = before.add(JobKind::kGo, {"lab"});
  before.run(3.0);
  PretendedRobot robot;
  robot.executor.load(before.executor.table());
  robot.run(3.0);
  EXPECT_THAT(robot.goals, ElementsAre("lab"));
  EXPECT_EQ(robot.navigation.goal_id, before.executor.goal()->id);
  EXPECT_EQ(robot.job(job).state, JobState::kDriving);
}

TEST(LeftOverJobs, BeginAGuideAnewAlsoWhileItWaited) {
  PretendedRobot before;
  const std::int64_t job = before.add(JobKind::kGuide, {"lab"});
  before.run(3.0);
  before.say(Action::kConfirm, job, "wait");
  before.run(1.0);
  ASSERT_EQ(before.navigation.state, Drive::kPaused);
  PretendedRobot robot;
  robot.navigation = before.navigation;
  robot.executor.load(before.executor.table());
  robot.run(1.0);
  EXPECT_EQ(robot.navigation.state, Drive::kCancelled);
  robot.run(3.0);
  EXPECT_THAT(robot.goals, ElementsAre("lab"));
  EXPECT_EQ(robot.job(job).state, JobState::kDriving);
}

TEST(LeftOverJobs, CancelTheDriveOfAJobThatWasCancelledJustBefore) {
  PretendedRobot before;
  const std::int64_t job = before.add(JobKind::kGo, {"lab"});
  before.run(3.0);
  before.is_deaf = true;
  before.say(Action::kCancel, job);
  PretendedRobot robot;
  robot.navigation = before.navigation;
  robot.executor.load(before.executor.table());
  robot.run(1.0);
  EXPECT_EQ(robot.navigation.state, Drive::kCancelled);
}

TEST(LeftOverJobs, AskWhereNothingMayMoveByItself) {
  PretendedRobot before;
  const std::int64_t first = before.add(JobKind::kGo, {"lab"});
  const std::int64_t second = before.add(JobKind::kGo, {"office"});
  before.run(3.0);
  PretendedRobot robot;
  robot.last_id = before.last_id;
  robot.executor.load(before.executor.table());
  const std::int64_t fresh = robot.add(JobKind::kGo, {"office"});
  robot.executor.ask_for_left_over("the machine was started anew since");
  robot.run(3.0);
  EXPECT_EQ(robot.job(first).state, JobState::kAsking);
  EXPECT_EQ(robot.job(second).state, JobState::kAsking);
  EXPECT_EQ(robot.job(fresh).state, JobState::kDriving) << "what somebody orders now is done";
  robot.arrive();
  robot.run(10.0);
  EXPECT_THAT(robot.goals, ElementsAre("office"));
  EXPECT_EQ(robot.say(Action::kAnswer, first, "go on"), "");
  EXPECT_EQ(robot.say(Action::kAnswer, second, "give up"), "");
  robot.run(3.0);
  EXPECT_THAT(robot.goals, ElementsAre("office", "lab"));
  EXPECT_EQ(robot.job(second).state, JobState::kFailed);
}

TEST(LeftOverJobs, OfAServiceThatEndsInOrderAreNotDrivenOn) {
  PretendedRobot robot;
  robot.add(JobKind::kGo, {"lab"});
  robot.run(3.0);
  const std::optional<DriveRequest> farewell = robot.executor.end();
  ASSERT_TRUE(farewell);
  EXPECT_EQ(farewell->action, DriveAction::kCancel);
  EXPECT_GT(farewell->id, robot.navigation.goal_id);
}

}  // namespace
}  // namespace luminav
