#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/node/planner/planner_world.hpp"

namespace luminav {
namespace {

using Status = navigation_status_t;
using ::testing::HasSubstr;

TEST(GoalHolding, WaitsBeforeAClosedDoorAndGoesOnWhenItOpens) {
  PlannerConfig config;
  config.doors = {{1, {6.2, 3.25, 0.5 * kPi}, 0.9}};
  PlannerWorld world(config);
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.obstacle(6.1, 2.8, 6.2, 3.7);
  world.run(6.0);
  EXPECT_EQ(world.status.state, Status::STATE_WAITING);
  EXPECT_THAT(world.status.cause, HasSubstr("door at (6.2, 3.2) is blocked, 0.0 m free, need 0.6 m; waiting 10 s"));
  EXPECT_LT(world.robot.x, 5.8);
  world.obstacle(6.1, 2.8, 6.2, 3.7, false);
  ASSERT_TRUE(world.run_until_state(40.0, Status::STATE_ARRIVED));
}

TEST(GoalHolding, MakesWayForWhoComesOutOfTheDoorItWaitsBefore) {
  PlannerConfig config;
  config.doors = {{1, {6.2, 3.25, 0.5 * kPi}, 0.9}};
  PlannerWorld world(config);
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.obstacle(6.1, 3.0, 6.4, 3.5);
  ASSERT_TRUE(world.run_until_state(20.0, Status::STATE_WAITING));
  world.run(9.0);
  const double beside_before = std::abs(world.robot.y - 3.25);
  EXPECT_LT(beside_before, 0.4) << "a thing is looked at from before it";
  EXPECT_LT(world.robot.x, 5.8);
  world.obstacle(6.1, 3.0, 6.4, 3.5, false);
  world.obstacle(5.7, 3.0, 6.0, 3.5);
  ASSERT_TRUE(world.run_until(15.0, [&] { return std::abs(world.robot.y - 3.25) > 0.8; })) << world.status.cause;
  EXPECT_EQ(world.status.state, Status::STATE_WAITING);
  EXPECT_THAT(world.status.cause, HasSubstr("making way"));
  EXPECT_LT(world.robot.x, 6.0);
  world.obstacle(5.7, 3.0, 6.0, 3.5, false);
  EXPECT_TRUE(world.run_until_state(40.0, Status::STATE_ARRIVED)) << world.status.cause;
}

TEST(GoalHolding, DoesNotWaitInADoor) {
  PlannerConfig config;
  config.doors = {{1, {6.2, 3.25, 0.5 * kPi}, 0.9}};
  PlannerWorld world(config);
  world.go(1, 7.5, 3.2);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.obstacle(7.2, 2.9, 7.8, 3.5);  // who stands at the goal would have to pass
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_WAITING));
  world.run(12.0);
  EXPECT_EQ(world.status.state, Status::STATE_WAITING);
  EXPECT_LT(world.robot.x, 5.9);
  EXPECT_GT(std::abs(world.robot.y - 3.25), 0.8);
  EXPECT_LT(std::abs(wrap_angle(std::atan2(3.25 - world.robot.y, 6.2 - world.robot.x) - world.robot.theta)), 0.3);
}

TEST(GoalHolding, TurnsTowardsWhatBlocksItWhileItWaits) {
  PlannerWorld world;
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.obstacle(6.1, 2.8, 6.2, 3.7);
  ASSERT_TRUE(world.run_until_state(20.0, Status::STATE_WAITING));
  world.run(8.0);                      // to the door
  world.robot.theta += radians(69.0);  // between two cones
  world.run(15.0);
  EXPECT_EQ(world.status.state, Status::STATE_WAITING);
  const double towards_door = std::atan2(3.2 - world.robot.y, 6.15 - world.robot.x);
  EXPECT_LT(std::abs(wrap_angle(world.robot.theta - towards_door)), radians(30.0));
  EXPECT_LT(world.robot.x, 5.8) << "it only turns";
  world.obstacle(6.1, 2.8, 6.2, 3.7, false);  // seen, it is gone
  EXPECT_TRUE(world.run_until_state(40.0, Status::STATE_ARRIVED)) << world.status.cause;
}

TEST(GoalHolding, CallsADoorThatStaysClosedBlockedInBoundedTime) {
  PlannerConfig config;
  config.doors = {{1, {6.2, 3.25, 0.5 * kPi}, 0.9}};
  PlannerWorld world(config);
  world.obstacle(6.1, 2.8, 6.2, 3.7);
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(120.0, Status::STATE_BLOCKED));
  EXPECT_THAT(world.status.cause, HasSubstr("door at (6.2, 3.2) is blocked"));
  EXPECT_GT(world.robot.x, 4.0) << "it waits before the door, not where it was";
}

TEST(GoalHolding, LooksFromNearByAtWhatLiesOnTheGoalBeforeItGivesUp) {
  PlannerWorld world;
  world.go(1, 4.5, 3.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.obstacle(4.4, 2.9, 4.6, 3.1);
  ASSERT_TRUE(world.run_until_state(10.0, Status::STATE_WAITING));
  const auto distance_to_goal = [&] { return std::hypot(world.robot.x - 4.5, world.robot.y - 3.0); };
  world.run(15.0);
  EXPECT_EQ(world.status.state, Status::STATE_WAITING);
  EXPECT_GT(distance_to_goal(), 0.6);
  ASSERT_TRUE(world.run_until(30.0, [&] { return distance_to_goal() < 0.5; })) << world.status.cause;
  EXPECT_THAT(world.status.cause, HasSubstr("lies in or beside an obstacle"));
  ASSERT_TRUE(world.run_until_state(120.0, Status::STATE_BLOCKED)) << world.status.cause;
}

TEST(GoalHolding, ArrivesWhenTheSecondLookFindsTheGoalFree) {
  PlannerWorld world;
  world.go(1, 4.5, 3.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.obstacle(4.4, 2.9, 4.6, 3.1);
  ASSERT_TRUE(world.run_until(60.0, [&] { return std::hypot(world.robot.x - 4.5, world.robot.y - 3.0) < 0.5; }));
  world.obstacle(4.4, 2.9, 4.6, 3.1, false);
  EXPECT_TRUE(world.run_until_state(30.0, Status::STATE_ARRIVED)) << world.status.cause;
}

TEST(GoalHolding, SaysWhyItWaitsAgainOnceThePoseIsBack) {
  PlannerWorld world;
  world.obstacle(6.1, 2.8, 6.2, 3.7);
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(20.0, Status::STATE_WAITING));
  const std::string cause = world.status.cause;
  world.tracking = false;
  world.run(0.5);
  EXPECT_EQ(world.status.cause, "no fixture seen yet");
  world.tracking = true;
  world.run(0.5);
  EXPECT_EQ(world.status.state, Status::STATE_WAITING);
  EXPECT_EQ(world.status.cause, cause);
}

TEST(GoalHolding, StandsByABlockageOnTheLongWayRound) {
  PlannerConfig config;
  config.goals.detour_ratio = 1.0;
  config.goals.detour_length = 0.0;
  PlannerWorld world(config);
  world.go(1, 4.5, 3.0);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  world.obstacle(3.3, 1.8, 3.5, 4.2);
  ASSERT_TRUE(world.run_until_state(30.0, Status::STATE_WAITING)) << world.status.cause;
  ASSERT_TRUE(world.run_until_state(60.0, Status::STATE_FOLLOWING)) << world.status.cause;
  const std::int32_t replans = world.status.replans;
  world.obstacle(3.3, 1.8, 3.5, 4.2, false);  // evidence fades behind the robot's back
  ASSERT_TRUE(world.run_until_state(60.0, Status::STATE_ARRIVED)) << world.status.cause;
  EXPECT_EQ(world.status.replans, replans);
}

}  // namespace
}  // namespace luminav
