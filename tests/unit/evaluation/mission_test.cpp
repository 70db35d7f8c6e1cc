#include "tests/evaluation/runs/mission.hpp"

#include <gtest/gtest.h>

#include <luminav/initial_pose_t.hpp>
#include <luminav/pose_t.hpp>
#include <vector>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kTick = 100'000;  // [us]

enum class Mishap { kNone, kCarried, kBumped };

/// The robot stands at `pose` and its planner says ARRIVED as soon as it is asked: how the only goal ended. Two ticks
/// later it may be carried to the origin, or pushed there.
GoalResult arrive(const ScenarioGoal& goal, const Pose2& pose, Mishap mishap = Mishap::kNone) {
  constexpr double kBumpAt = 1.4;  // [s] since the first truth: the goal is sent after 1 s
  lcm::LCM lcm("memq://");
  Scenario scenario;
  scenario.goals = {goal};
  if (mishap == Mishap::kBumped) {
    ScenarioEvent& bump = scenario.events.emplace_back();
    bump.at = kBumpAt;
    bump.kind = EventKind::kBump;
  }
  Mission mission(lcm, scenario);
  int ticks_arrived = 0;
  for (std::int64_t utime = kTick; utime < 100 * kTick && !mission.is_finished(); utime += kTick) {
    sim_truth_t truth{};
    truth.utime = utime;
    truth.x = pose.x;
    truth.y = pose.y;
    truth.theta = pose.theta;
    const bool is_bumped = mishap == Mishap::kBumped && static_cast<double>(utime - kTick) * 1e-6 > kBumpAt;
    const bool is_carried = mishap == Mishap::kCarried && ticks_arrived > 2;
    if (is_bumped || is_carried) {
      truth.x = truth.y = truth.theta = 0.0;
    }
    truth.carried = is_carried;
    lcm.publish(channels::kSimTruth, &truth);
    if (mission.goal_id() != 0) {
      navigation_status_t status{};
      status.utime = utime;
      status.goal_id = mission.goal_id();
      status.state = navigation_status_t::STATE_ARRIVED;
      lcm.publish(channels::kNavigationStatus, &status);
      ++ticks_arrived;
    }
    while (lcm.handleTimeout(0) > 0) {
    }
  }
  EXPECT_TRUE(mission.is_finished());
  return mission.final_results().at(0);
}

ScenarioGoal goal_with_heading(double theta) {
  ScenarioGoal goal;
  goal.pose = {2.0, 3.0, theta};
  goal.has_theta = true;
  return goal;
}

TEST(Mission, CountsAGoalAsReachedOnlyInTheHeadingThatWasAskedFor) {
  const ScenarioGoal goal = goal_with_heading(radians(178.0));
  const GoalResult right = arrive(goal, {2.1, 3.0, radians(-178.0)});
  EXPECT_TRUE(right.reached);
  EXPECT_NEAR(right.heading_error_deg.value(), 4.0, 1e-9);
  const GoalResult turned = arrive(goal, {2.1, 3.0, radians(-2.0)});
  EXPECT_FALSE(turned.reached);
  EXPECT_NEAR(turned.heading_error_deg.value(), 180.0, 1e-9);
  EXPECT_NE(turned.cause.find("180 deg"), std::string::npos);
  EXPECT_FALSE(arrive(goal, {2.3, 3.0, radians(178.0)}).reached);
}

TEST(Mission, JudgesAnArrivalWhereTheRobotWasLiftedOrBumped) {
  const ScenarioGoal goal = goal_with_heading(0.0);
  for (const Mishap mishap : {Mishap::kCarried, Mishap::kBumped}) {
    EXPECT_TRUE(arrive(goal, {2.1, 3.0, 0.0}, mishap).reached);
    EXPECT_FALSE(arrive(goal, {2.5, 3.0, 0.0}, mishap).reached);
  }
}

struct ToldPoses {
  std::vector<initial_pose_t> all;
  void add(const lcm::ReceiveBuffer*, const std::string&, const initial_pose_t* message) { all.push_back(*message); }
};

TEST(Mission, TellsAKnownStartAlsoWhereItWasDrawn) {
  lcm::LCM lcm("memq://");
  Scenario scenario;
  scenario.goals = {goal_with_heading(0.0)};
  scenario.start_known = true;  // and no place in the scenario: the simulator draws one
  Mission mission(lcm, scenario);
  ToldPoses told;
  lcm.subscribe(channels::kInitialPose, &ToldPoses::add, &told);
  sim_truth_t truth{};
  truth.x = 2.0;
  truth.y = 3.0;
  truth.theta = 0.5;
  for (truth.utime = kTick; truth.utime < 100 * kTick; truth.utime += kTick) {
    lcm.publish(channels::kSimTruth, &truth);
    while (lcm.handleTimeout(0) > 0) {
    }
  }
  ASSERT_FALSE(told.all.empty());
  EXPECT_EQ(told.all.front().x, 2.0);
  EXPECT_EQ(told.all.front().y, 3.0);
  EXPECT_EQ(told.all.front().theta, 0.5);
}

TEST(Mission, TellsItsStartAboveTheGuessThatTheLocalizerHasTakenUp) {
  lcm::LCM lcm("memq://");
  Scenario scenario;
  scenario.goals = {goal_with_heading(0.0)};
  scenario.start_known = true;
  Mission mission(lcm, scenario);
  ToldPoses told;
  lcm.subscribe(channels::kInitialPose, &ToldPoses::add, &told);
  pose_t pose{};
  pose.utime = kTick;
  pose.initial_pose_id = 3'600'000'000;  // of somebody whose clock is an hour ahead
  lcm.publish(channels::kPose, &pose);
  sim_truth_t truth{};
  for (truth.utime = kTick; truth.utime < 100 * kTick; truth.utime += kTick) {
    lcm.publish(channels::kSimTruth, &truth);
    while (lcm.handleTimeout(0) > 0) {
    }
  }
  ASSERT_FALSE(told.all.empty());
  EXPECT_GT(told.all.front().id, pose.initial_pose_id);
  EXPECT_EQ(told.all.back().id, told.all.front().id);
  const std::size_t count = told.all.size();
  pose.initial_pose_id = told.all.back().id + 1;  // a person who tells after it stands
  lcm.publish(channels::kPose, &pose);
  for (; truth.utime < 200 * kTick; truth.utime += kTick) {
    lcm.publish(channels::kSimTruth, &truth);
    while (lcm.handleTimeout(0) > 0) {
    }
  }
  EXPECT_EQ(told.all.size(), count);
}

TEST(Mission, AsksForNoHeadingWhereTheGoalHasNone) {
  ScenarioGoal goal = goal_with_heading(0.0);
  goal.has_theta = false;
  const GoalResult result = arrive(goal, {2.1, 3.0, 3.0});
  EXPECT_TRUE(result.reached);
  EXPECT_FALSE(result.heading_error_deg.has_value());
}

/// A robot that stands, and a planner that is asked by the mission and by somebody else.
class SharedRobot : public ::testing::Test {
 protected:
  SharedRobot() { scenario_.goals = {goal_with_heading(0.0)}; }

  void pass(std::int64_t ticks, std::int64_t goal_id, int state) {
    for (std::int64_t i = 0; i < ticks; ++i) {
      sim_truth_t truth{};
      truth.utime = utime_ += kTick;
      truth.x = 2.0;
      truth.y = 3.0;
      lcm_.publish(channels::kSimTruth, &truth);
      navigation_status_t status{};
      status.utime = utime_;
      status.goal_id = goal_id;
      status.state = static_cast<std::int8_t>(state);
      lcm_.publish(channels::kNavigationStatus, &status);
      while (lcm_.handleTimeout(0) > 0) {
      }
    }
  }

  lcm::LCM lcm_{"memq://"};
  Scenario scenario_;
  std::int64_t utime_ = 0;
};

TEST_F(SharedRobot, MissionSendsItsGoalAgainWhenSomebodyElsesHasEnded) {
  Mission mission(lcm_, scenario_);
  pass(20, 0, navigation_status_t::STATE_IDLE);
  const std::int64_t first = mission.goal_id();
  pass(5, first, navigation_status_t::STATE_FOLLOWING);
  EXPECT_FALSE(mission.is_interrupted());
  const std::int64_t foreign = first + 1'000'000'000;
  pass(100, foreign, navigation_status_t::STATE_FOLLOWING);
  EXPECT_TRUE(mission.is_interrupted());
  EXPECT_EQ(mission.goal_id(), first) << "somebody else's goal is not taken away";
  pass(100, foreign, navigation_status_t::STATE_CANCELLED);
  EXPECT_FALSE(mission.is_interrupted());
  EXPECT_GT(mission.goal_id(), foreign);
  pass(30, mission.goal_id(), navigation_status_t::STATE_ARRIVED);
  EXPECT_TRUE(mission.is_finished());
  EXPECT_EQ(mission.failure(), "");
}

TEST_F(SharedRobot, MissionLeavesAGoalThatSomebodyPausedAlone) {
  Mission mission(lcm_, scenario_);
  pass(20, 0, navigation_status_t::STATE_IDLE);
  const std::int64_t first = mission.goal_id();
  pass(5, first, navigation_status_t::STATE_FOLLOWING);
  pass(200, first + 1, navigation_status_t::STATE_PAUSED);
  EXPECT_TRUE(mission.is_interrupted());
  EXPECT_EQ(mission.goal_id(), first);
}

}  // namespace
}  // namespace luminav
