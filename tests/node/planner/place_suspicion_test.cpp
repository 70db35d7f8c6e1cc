#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/node/planner/planner_world.hpp"

namespace luminav {
namespace {

using Status = navigation_status_t;
using ::testing::HasSubstr;

/// The wall beside the door is a metre thick: whoever stands in it has no room on any side.
struct WorldWithThickWall : PlannerWorld {
  WorldWithThickWall() { wall(58, 0, 68, 28); }
  static constexpr Pose2 kInTheWall{6.3, 1.5, 0.0};
};

TEST(PlaceSuspicion, GoesOnWhenThePoseComesBackOutOfTheWall) {
  WorldWithThickWall world;
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(5.0, Status::STATE_FOLLOWING));
  const Pose2 before = world.robot;
  world.robot = WorldWithThickWall::kInTheWall;  // somebody carries it, and the pose follows through the wall
  world.run(3.0);
  EXPECT_EQ(world.status.state, Status::STATE_WAITING);
  EXPECT_THAT(world.status.cause, HasSubstr("the map leaves a robot no room at (6."));
  EXPECT_EQ(world.path.count, 0) << "it stands still at first";
  world.robot = before;
  EXPECT_TRUE(world.run_until_state(60.0, Status::STATE_ARRIVED)) << world.status.cause;
}

TEST(PlaceSuspicion, LastsAsLongAsItMayNotMoveAndThenALookRound) {
  WorldWithThickWall world;
  world.robot = WorldWithThickWall::kInTheWall;
  world.motors = false;  // somebody carries it
  world.go(1, 9.0, 3.2);
  world.run(90.0);
  EXPECT_EQ(world.status.state, Status::STATE_WAITING) << world.status.cause;
  EXPECT_EQ(world.robot.theta, 0.0);
  world.motors = true;
  double turned = 0.0;
  double last = world.robot.theta;
  ASSERT_TRUE(world.run_until(40.0, [&] {
    turned += wrap_angle(world.robot.theta - last);
    last = world.robot.theta;
    return world.status.state == Status::STATE_NO_PATH;
  })) << world.status.cause;
  EXPECT_GT(turned, 2.0 * kPi);
  EXPECT_NEAR(world.robot.x, 6.3, 0.01) << "it only turns";
}

TEST(PlaceSuspicion, EndsWithSayingThatThePlaceIsEnclosed) {
  PlannerWorld world;
  world.robot = {2.05, 3.05, 0.0};
  world.wall(17, 27, 24, 28);
  world.wall(17, 33, 24, 34);
  world.wall(17, 27, 18, 34);
  world.wall(23, 27, 24, 34);
  world.go(1, 9.0, 3.2);
  ASSERT_TRUE(world.run_until_state(40.0, Status::STATE_NO_PATH));
  EXPECT_THAT(world.status.cause, HasSubstr("the robot's own place is enclosed"));
}

}  // namespace
}  // namespace luminav
