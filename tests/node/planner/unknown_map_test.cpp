#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/node/planner/planner_world.hpp"

namespace luminav {
namespace {

using Status = navigation_status_t;
using ::testing::HasSubstr;

/// The two rooms as the robot has drawn them itself, with a thin leaf in the door that is not there.
void draw_by_sonar(PlannerWorld& world) {
  for (std::size_t i = 0; i < world.grid.prior.size(); ++i) {
    world.grid.evidence[i] = world.grid.prior[i] == Prior::kOccupied ? 50 : -20;
    world.grid.prior[i] = Prior::kUnknown;
  }
  for (int row = 28; row < 37; ++row) {
    world.grid.evidence[world.grid.geometry.index({61, row})] = 30;
  }
}

PlannerConfig mapping_config() {
  PlannerConfig config;
  config.route.space.unknown_is_free = true;
  config.route.space.hard_radius = 0.25;
  return config;
}

TEST(UnknownMap, LooksFromNearAtADoorThatItDrewShut) {
  PlannerWorld world(mapping_config());
  draw_by_sonar(world);
  world.robot = {2.0, 5.4, 0.0};
  world.go(1, 10.0, 5.4);
  const auto stands_before_it = [&] { return std::hypot(world.robot.x - 6.1, world.robot.y - 3.2) < 0.8; };
  ASSERT_TRUE(world.run_until(30.0, stands_before_it)) << world.status.cause;
  EXPECT_THAT(world.status.cause, HasSubstr("looking at it from near"));
  world.obstacle(6.1, 2.8, 6.2, 3.7, false);  // so near the leaf is seen through
  EXPECT_TRUE(world.run_until_state(40.0, Status::STATE_ARRIVED)) << world.status.cause;
}

TEST(UnknownMap, LooksAtTheDoorBeforeItGoesRoundThroughWhatNobodyHasSeen) {
  PlannerWorld world(mapping_config());
  draw_by_sonar(world);
  for (int row = 44; row < 64; ++row) {
    for (int column = 61; column < 124; ++column) {
      world.grid.evidence[world.grid.geometry.index({column, row})] = 0;  // the wall ends, or was not seen there
    }
  }
  world.robot = {4.0, 2.0, 0.0};
  world.go(1, 8.5, 2.0);  // 8.5 m round, 5 m through the door
  const auto looks = [&] { return world.status.cause.find("looking at it from near") != std::string::npos; };
  EXPECT_TRUE(world.run_until(2.0, looks)) << world.status.cause;
}

TEST(UnknownMap, LooksAtNoObstacleThatIsOnlySuspected) {
  PlannerWorld world(mapping_config());
  draw_by_sonar(world);
  world.obstacle(6.1, 2.8, 6.2, 3.7, false);
  world.robot = {5.6, 3.2, 0.0};
  world.wheels_blocked = true;  // it gets nowhere, and suspects something in the door
  world.go(1, 10.0, 3.2);
  const auto looks = [&] { return world.status.cause.find("looking at it from near") != std::string::npos; };
  EXPECT_FALSE(world.run_until(50.0, looks)) << world.status.cause;
  EXPECT_TRUE(world.run_until_state(60.0, Status::STATE_STUCK)) << world.status.cause;
}

TEST(UnknownMap, GivesUpAGoalThatItsOwnMapLeadsItRoundFor) {
  PlannerConfig config = mapping_config();
  config.goals.search_ratio = 1.0;
  config.goals.search_length = 8.0;
  PlannerWorld world(config);
  world.go(1, 10.0, 3.2);
  const auto carries_on = [&] {
    if (world.robot.x > 5.0) {
      world.robot.x = 2.0;  // as if each way had led it back
    }
    return world.status.state == Status::STATE_NO_PATH;
  };
  ASSERT_TRUE(world.run_until(60.0, carries_on)) << world.status.cause;
  EXPECT_THAT(world.status.cause, HasSubstr("m of driving, 8."));
}

TEST(UnknownMap, SearchesAnewWhenItTriesAgain) {
  PlannerConfig config = mapping_config();
  config.goals.search_ratio = 1.0;
  config.goals.search_length = 8.0;
  PlannerWorld world(config);
  goal_t goal = world.goal(1, {{10.0, 3.2}});
  goal.policy = goal_t::POLICY_RETRY;
  world.send(goal);
  const auto in_vain = [&] {
    if (world.robot.x > 5.0) {
      world.robot.x = 2.0;
    }
    return world.status.cause.find("trying again") != std::string::npos;
  };
  ASSERT_TRUE(world.run_until(60.0, in_vain)) << world.status.cause;
  EXPECT_TRUE(world.run_until_state(60.0, Status::STATE_ARRIVED)) << world.status.cause;
}

TEST(UnknownMap, GivesUpWhenTheDoorThatItDrewStaysShut) {
  PlannerWorld world(mapping_config());
  draw_by_sonar(world);
  world.go(1, 10.0, 5.4);
  ASSERT_TRUE(world.run_until_state(400.0, Status::STATE_BLOCKED)) << world.status.cause;
  EXPECT_THAT(world.status.cause, HasSubstr("is blocked"));
}

}  // namespace
}  // namespace luminav
