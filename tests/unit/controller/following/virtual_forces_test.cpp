#include "services/controller/following/virtual_forces.hpp"

#include <gtest/gtest.h>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

using testing::around;
using testing::obstacle_at;

TEST(VirtualForce, PullsTowardsTheGoalWithOne) {
  const VirtualForce force = virtual_force({3.0, 4.0}, around(), {});
  EXPECT_NEAR(force.attractive.x(), 0.6, 1e-12);
  EXPECT_NEAR(force.attractive.y(), 0.8, 1e-12);
  EXPECT_DOUBLE_EQ(force.repulsive.norm(), 0.0);
}

TEST(VirtualForce, PushesAwayFromAnObstacleMoreTheNearerItIs) {
  const std::vector<ObstaclePoint> near{obstacle_at(0.1, 0.3)};
  const std::vector<ObstaclePoint> far{obstacle_at(0.1, 0.5)};
  const double strong = -virtual_force({1.0, 0.0}, around(near), {}).repulsive.y();
  const double weak = -virtual_force({1.0, 0.0}, around(far), {}).repulsive.y();
  EXPECT_GT(strong, weak);
  EXPECT_GT(weak, 0.0);
}

TEST(VirtualForce, CancelsInTheMiddleOfACorridor) {
  auto corridor = testing::wall({-1.0, 0.45}, {1.0, 0.45});
  for (const ObstaclePoint& point : testing::wall({-1.0, -0.45}, {1.0, -0.45})) {
    corridor.push_back(point);
  }
  EXPECT_NEAR(virtual_force({1.0, 0.0}, around(corridor), {}).repulsive.y(), 0.0, 0.02);
}

TEST(VirtualForce, NeverOutweighsTheGoal) {
  const auto close = testing::wall({0.23, -0.3}, {0.23, 0.3});
  const VirtualForce force = virtual_force({1.0, 0.0}, around(close), {});
  EXPECT_LE(force.repulsive.norm(), VirtualForceParams{}.max + 1e-12);
  EXPECT_GT(force.resultant().x(), 0.0);
}

TEST(VirtualForce, IsMirroredWhenTheWorldIs) {
  const std::vector<ObstaclePoint> left{obstacle_at(0.3, 0.35), obstacle_at(0.5, 0.1)};
  const std::vector<ObstaclePoint> right{obstacle_at(0.3, -0.35), obstacle_at(0.5, -0.1)};
  const VirtualForce a = virtual_force({1.0, 0.3}, around(left), {});
  const VirtualForce b = virtual_force({1.0, -0.3}, around(right), {});
  EXPECT_NEAR(a.resultant().x(), b.resultant().x(), 1e-12);
  EXPECT_NEAR(a.resultant().y(), -b.resultant().y(), 1e-12);
}

TEST(VirtualForce, BearsAGoalUnderTheRobot) {
  EXPECT_DOUBLE_EQ(virtual_force({0.0, 0.0}, around(), {}).resultant().norm(), 0.0);
}

}  // namespace
}  // namespace luminav
