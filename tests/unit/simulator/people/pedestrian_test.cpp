#include "drivers/simulator/people/pedestrian.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kTick = 0.05;  // [s]

/// A corridor along x with walls at y = +-0.5 for somebody's middle, and a robot that stands in it.
struct Corridor {
  Vector2d robot{2.0, 0.0};
  double gap = 0.5;  // [m] nobody comes nearer to the robot's middle than that
  double left_wall = 0.5;
  double right_wall = -0.5;
  Pedestrian walker{WalkingPerson{.waypoints = {{0.0, 0.0}, {4.0, 0.0}}, .speed = 1.0}};

  void walk(double duration) {
    for (double t = 0.0; t < duration; t += kTick) {
      walker.step(kTick, [&](const Vector2d& point, bool is_beside_line) {
        if ((point - robot).norm() < gap && (point - robot).norm() < (walker.position() - robot).norm()) {
          return Obstruction::kRobot;
        }
        const bool in_wall = point.y() > left_wall || point.y() < right_wall;
        return is_beside_line && in_wall ? Obstruction::kWall : Obstruction::kNone;
      });
    }
  }
};

TEST(Pedestrian, StepsAsideForARobotThatIsInTheWay) {
  Corridor corridor;
  corridor.walk(2.3);
  EXPECT_NEAR(corridor.walker.position().x(), 1.5, 0.06);
  EXPECT_EQ(corridor.walker.position().y(), 0.0);
  corridor.walk(4.0);
  EXPECT_NEAR(corridor.walker.position().y(), -0.5, 0.06);
  EXPECT_NEAR(corridor.walker.position().x(), 1.5, 0.06);
}

TEST(Pedestrian, ComesBackToHisLineWhenTheRobotHasPassed) {
  Corridor corridor;
  corridor.walk(6.0);
  corridor.robot = {-1.0, 0.0};
  corridor.walk(2.0);
  EXPECT_GT(corridor.walker.position().x(), 2.5);
  EXPECT_NEAR(corridor.walker.position().y(), 0.0, 0.01);
}

TEST(Pedestrian, StepsToTheSideWithMoreRoom) {
  Corridor corridor;
  corridor.right_wall = -0.15;
  corridor.walk(6.0);
  EXPECT_NEAR(corridor.walker.position().y(), 0.5, 0.06);
}

TEST(Pedestrian, WalksBackWhenHeHasWaitedLong) {
  Corridor corridor;
  corridor.left_wall = 0.0;
  corridor.right_wall = 0.0;
  corridor.walk(11.0);
  EXPECT_NEAR(corridor.walker.position().x(), 1.5, 0.06);
  corridor.walk(2.0);
  EXPECT_LT(corridor.walker.position().x(), 1.0);
}

TEST(Pedestrian, WalksAwayBesideARobotThatStaysOnHisLine) {
  Corridor corridor;
  corridor.walk(6.0);
  corridor.robot = {1.7, 0.0};  // beside him, and there it stays
  double nearest_to_start = corridor.walker.position().x();
  for (int i = 0; i < 12; ++i) {
    corridor.walk(1.0);
    nearest_to_start = std::min(nearest_to_start, corridor.walker.position().x());
  }
  EXPECT_LT(nearest_to_start, 0.5);
}

TEST(Pedestrian, TurnsRoundAtAClosedDoor) {
  Pedestrian walker(WalkingPerson{.waypoints = {{0.0, 0.0}, {4.0, 0.0}}, .speed = 1.0});
  double farthest = 0.0;
  for (int i = 0; i < 100; ++i) {
    walker.step(kTick,
                [](const Vector2d& point, bool) { return point.x() > 2.0 ? Obstruction::kDoor : Obstruction::kNone; });
    farthest = std::max(farthest, walker.position().x());
  }
  EXPECT_NEAR(farthest, 2.0, 0.06);
  EXPECT_LT(walker.position().x(), 1.2);
}

}  // namespace
}  // namespace luminav
