#include "services/planner/planner_messages.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace luminav {
namespace {

TEST(PlannerMessages, ReadsWhatAGoalAsksFor) {
  goal_t message{};
  message.id = 7;
  message.loop = 1;
  message.policy = goal_t::POLICY_STOP;
  message.tolerance = 0.2;
  message.poses.resize(2);
  message.poses[0].place = "lift";
  message.poses[0].wait = 3.0;
  message.poses[1].x = 4.0;
  message.poses[1].has_theta = 1;
  message.poses[1].theta = 1.5 * std::numbers::pi;
  const GoalRequest request = request_from(message);
  EXPECT_EQ(request.id, 7);
  EXPECT_TRUE(request.loop);
  EXPECT_EQ(request.policy, FailurePolicy::kStop);
  EXPECT_EQ(request.tolerance, 0.2);
  ASSERT_EQ(request.stops.size(), 2U);
  EXPECT_EQ(request.stops[0].place, "lift");
  EXPECT_EQ(request.stops[0].wait, 3.0);
  EXPECT_FALSE(request.stops[0].has_theta);
  EXPECT_NEAR(request.stops[1].pose.theta, -0.5 * std::numbers::pi, 1e-9);
}

TEST(PlannerMessages, TellsThePathAndWhereItLeads) {
  GoalPath path;
  path.goal_id = 7;
  path.sequence = 3;
  path.points = {{1.0, 2.0}, {1.5, 2.5}};
  const path_t message = path_message(path, 9);
  EXPECT_EQ(message.utime, 9);
  EXPECT_EQ(message.count, 2);
  EXPECT_EQ(message.x[1], 1.5F);
  EXPECT_EQ(message.y[1], 2.5F);
  NavigationReport report;
  report.state = NavigationState::kFollowing;
  report.goal_id = 7;
  EXPECT_EQ(navigation_message(report, path, 9).has_target, 0);
  report.target = GoalStop{"lift", {4.0, 5.0, 0.5}, true, 0.0};
  const navigation_status_t status = navigation_message(report, path, 9);
  EXPECT_EQ(status.state, navigation_status_t::STATE_FOLLOWING);
  EXPECT_EQ(status.path_sequence, 3);
  EXPECT_EQ(status.has_target, 1);
  EXPECT_EQ(status.y, 5.0);
  EXPECT_EQ(status.theta, 0.5);
}

}  // namespace
}  // namespace luminav
