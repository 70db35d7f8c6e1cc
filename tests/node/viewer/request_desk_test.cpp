#include "services/viewer/request_desk.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "services/common/process/channels.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/viewer/request_text.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kStart = 1'000'000'000'000;
using Fate = RequestDesk::Fate;

class RequestDeskTest : public ::testing::Test {
 protected:
  RequestDeskTest() : subscriber_(lcm_) {
    subscriber_.on(channels::kGoal, &RequestDeskTest::on_goal, this);
    subscriber_.on(channels::kStop, &RequestDeskTest::on_stop, this);
    subscriber_.on(channels::kJob, &RequestDeskTest::on_job, this);
  }
  void on_goal(const goal_t& message) { goals_.push_back(message); }
  void on_stop(const stop_t& message) { stops_.push_back(message); }
  void on_job(const job_t& message) { jobs_.push_back(message); }
  void deliver() {
    while (lcm_.handleTimeout(0) > 0) {
    }
  }
  std::int64_t ask_for_stop(bool engaged) {
    stop_t stop{};
    stop.engaged = engaged ? 1 : 0;
    return desk_.send(stop, kStart);
  }
  void driver_says(std::int64_t stop_id, bool engaged) {
    robot_status_t status{};
    status.stop_id = stop_id;
    status.stop_engaged = engaged ? 1 : 0;
    desk_.on_robot_status(status);
  }
  void controller_says(std::int64_t stop_id, bool engaged) {
    control_status_t status{};
    status.stop_id = stop_id;
    status.stop_engaged = engaged ? 1 : 0;
    desk_.on_control_status(status);
  }
  Fate fate_of(RequestDesk::Kind kind) {
    for (const RequestDesk::State& state : desk_.states()) {
      if (state.kind == kind) {
        return state.fate;
      }
    }
    return Fate::kNone;
  }

  lcm::LCM lcm_{"memq://"};
  RequestDesk desk_{lcm_, "viewer@desk"};
  Subscriber subscriber_;
  std::vector<goal_t> goals_;
  std::vector<stop_t> stops_;
  std::vector<job_t> jobs_;
};

TEST_F(RequestDeskTest, RepeatsEachOfTenJobsUntilItIsEchoed) {
  job_status_t status{};
  for (int i = 0; i < 10; ++i) {
    const std::int64_t id = desk_.send(job_t{}, kStart);
    if (i % 2 == 0) {
      status.echo_ids.push_back(id);
      status.objections.emplace_back();
    }
  }
  deliver();
  EXPECT_EQ(jobs_.size(), 10U);
  EXPECT_EQ(jobs_[9].sender, "viewer@desk");
  status.echo_count = 5;
  desk_.on_job_status(status);
  desk_.repeat(kStart + 200'000);
  deliver();
  EXPECT_EQ(jobs_.size(), 15U);
  desk_.repeat(kStart + 11'000'000);
  deliver();
  EXPECT_EQ(jobs_.size(), 15U) << "nobody waits any more";
}

TEST_F(RequestDeskTest, ASurveyCommandWaitsForTheSurveyorsEcho) {
  survey_command_t command{};
  command.action = survey_command_t::ACTION_PLACE;
  command.name = "lift";
  survey_status_t status{};
  status.echo_id = desk_.send(command, kStart);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kSurvey), Fate::kWaiting);
  status.objection = "the survey is finished";
  desk_.on_survey_status(status);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kSurvey), Fate::kAnswered);
  EXPECT_EQ(desk_.states()[0].objection, "the survey is finished");
}

TEST_F(RequestDeskTest, NumbersItsJobsAboveThoseOfSomebodyWhoseClockIsAhead) {
  job_status_t status{};
  status.echo_count = 1;
  status.echo_ids = {kStart + 3'600'000'000};
  status.objections = {""};
  desk_.on_job_status(status);
  EXPECT_GT(desk_.send(job_t{}, kStart), kStart + 3'600'000'000);
}

TEST_F(RequestDeskTest, NumbersItsJobsAboveThoseThatNobodyRequested) {
  job_status_t status{};
  status.count = 1;
  status.jobs.resize(1);
  status.jobs[0].id = kStart + 3'600'000'000;  // a tour by the robot's clock
  desk_.on_job_status(status);
  EXPECT_GT(desk_.send(job_t{}, kStart), kStart + 3'600'000'000);
}

TEST_F(RequestDeskTest, RefusesPlacesOfAnotherBuildingButNeverAStop) {
  desk_.object("building laboratory, but planner@desk has office");
  goal_t go{};
  go.action = goal_t::ACTION_GO;
  EXPECT_THROW(desk_.send(go, kStart), RequestError);
  EXPECT_THROW(desk_.send(initial_pose_t{}, kStart), RequestError);
  goal_t cancel{};
  cancel.action = goal_t::ACTION_CANCEL;
  desk_.send(cancel, kStart);
  desk_.send(stop_t{}, kStart);
  deliver();
  ASSERT_EQ(goals_.size(), 1U);
  EXPECT_EQ(goals_[0].action, goal_t::ACTION_CANCEL);
  EXPECT_EQ(stops_.size(), 1U);
  desk_.object("");
  EXPECT_NO_THROW(desk_.send(go, kStart + 1));
}

TEST_F(RequestDeskTest, SendsAtOnceAndRepeatsUntilTheIdIsEchoed) {
  const std::int64_t id = desk_.send(goal_t{}, kStart);
  deliver();
  ASSERT_EQ(goals_.size(), 1U);
  EXPECT_EQ(goals_[0].id, id);
  desk_.repeat(kStart + 200'000);
  deliver();
  ASSERT_EQ(goals_.size(), 2U);
  EXPECT_EQ(goals_[1].id, id);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kGoal), Fate::kWaiting);
  navigation_status_t status{};
  status.goal_id = id - 1;
  desk_.on_navigation_status(status);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kGoal), Fate::kWaiting);
  status.goal_id = id;
  desk_.on_navigation_status(status);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kGoal), Fate::kAnswered);
  desk_.repeat(kStart + 400'000);
  deliver();
  EXPECT_EQ(goals_.size(), 2U);
}

TEST_F(RequestDeskTest, GivesUpOnAGoalButNeverOnAStop) {
  desk_.send(goal_t{}, kStart);
  stop_t stop{};
  stop.engaged = 1;
  desk_.send(stop, kStart);
  desk_.repeat(kStart + 11'000'000);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kGoal), Fate::kUnanswered);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kStop), Fate::kWaiting);
  deliver();
  EXPECT_EQ(goals_.size(), 1U);
  EXPECT_EQ(stops_.size(), 2U);
}

TEST_F(RequestDeskTest, AStopNeedsDriverAndController) {
  const std::int64_t id = ask_for_stop(true);
  driver_says(id, true);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kStop), Fate::kWaiting);
  controller_says(id, true);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kStop), Fate::kAnswered);
}

TEST_F(RequestDeskTest, AnEchoedIdAloneIsNoStop) {
  const std::int64_t id = ask_for_stop(true);
  driver_says(id, false);  // another desk's release, that has the same id
  controller_says(id, false);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kStop), Fate::kWaiting);
  deliver();
  desk_.repeat(kStart + 200'000);
  deliver();
  EXPECT_EQ(stops_.size(), 2U);
  driver_says(id, true);
  controller_says(id, true);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kStop), Fate::kAnswered);
}

TEST_F(RequestDeskTest, GivesAReleaseUpWhenSomebodyElseStops) {
  driver_says(7, true);
  controller_says(7, true);
  ask_for_stop(false);
  driver_says(7, true);  // not obeyed yet
  EXPECT_EQ(fate_of(RequestDesk::Kind::kStop), Fate::kWaiting);
  driver_says(9, true);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kStop), Fate::kUnanswered);
  deliver();
  stops_.clear();
  desk_.repeat(kStart + 200'000);
  deliver();
  EXPECT_TRUE(stops_.empty()) << "it would undo a stop that is newer";
}

TEST_F(RequestDeskTest, SaysWhoAsks) {
  ask_for_stop(true);
  deliver();
  EXPECT_EQ(stops_.at(0).sender, "viewer@desk");
}

TEST(RequestDesk, SaysWhenNothingWasSentAndTriesAStopAgain) {
  lcm::LCM network("no-such-network://");
  RequestDesk desk(network, "viewer");
  EXPECT_THROW(desk.send(goal_t{}, kStart), NotSent);
  stop_t stop{};
  stop.engaged = 1;
  EXPECT_THROW(desk.send(stop, kStart), NotSent);
  for (const RequestDesk::State& state : desk.states()) {
    EXPECT_EQ(state.fate, state.kind == RequestDesk::Kind::kStop ? Fate::kWaiting : Fate::kUnanswered);
  }
}

TEST_F(RequestDeskTest, ANewerRequestReplacesTheOlderOne) {
  stop_t stop{};
  stop.engaged = 1;
  const std::int64_t first = desk_.send(stop, kStart);
  stop.engaged = 0;
  const std::int64_t second = desk_.send(stop, kStart);
  EXPECT_GT(second, first);
  stops_.clear();
  deliver();
  stops_.clear();
  desk_.repeat(kStart + 200'000);
  deliver();
  ASSERT_EQ(stops_.size(), 1U);
  EXPECT_EQ(stops_[0].id, second);
  EXPECT_FALSE(stops_[0].engaged);
}

TEST_F(RequestDeskTest, NumbersAboveIdsOfHostsWhoseClockIsAhead) {
  desk_.send(goal_t{}, kStart);
  robot_status_t robot{};
  robot.motors_command_id = kStart + 60'000'000;
  desk_.on_robot_status(robot);
  EXPECT_GT(desk_.send(motors_command_t{}, kStart + 1), kStart + 60'000'000);
}

TEST_F(RequestDeskTest, CountsOnFromNoIdThatNoClockShows) {
  navigation_status_t status{};
  status.goal_id = std::numeric_limits<std::int64_t>::max();
  desk_.on_navigation_status(status);
  EXPECT_EQ(desk_.send(goal_t{}, kStart), kStart);
}

TEST_F(RequestDeskTest, EachKindHasItsOwnEcho) {
  const std::int64_t motors = desk_.send(motors_command_t{}, kStart);
  const std::int64_t guess = desk_.send(initial_pose_t{}, kStart);
  robot_status_t robot{};
  robot.motors_command_id = motors;
  desk_.on_robot_status(robot);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kMotors), Fate::kAnswered);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kInitialPose), Fate::kWaiting);
  pose_t pose{};
  pose.initial_pose_id = guess;
  desk_.on_pose(pose);
  EXPECT_EQ(fate_of(RequestDesk::Kind::kInitialPose), Fate::kAnswered);
}

}  // namespace
}  // namespace luminav
