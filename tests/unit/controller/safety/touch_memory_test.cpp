#include "services/controller/safety/touch_memory.hpp"

#include <gtest/gtest.h>

#include "services/controller/safety/stop_logic.hpp"
#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kSecond = 1'000'000;
const Pose2 kPlace{3.0, 2.0, 0.5 * kPi};  // odom

std::vector<ObstaclePoint> felt(const TouchMemory& touches, std::int64_t now, const Pose2& odom_from_robot) {
  std::vector<ObstaclePoint> obstacles;
  touches.append(now, odom_from_robot, obstacles);
  return obstacles;
}

SenseAges fresh() {
  SenseAges ages;
  ages.odometry = ages.sonar = ages.front_sonar = ages.rear_sonar = 0.1;
  return ages;
}

TEST(TouchMemory, KnowsAThingBeforeTheSideThatDroveAgainstIt) {
  TouchMemory touches(testing::test_robot());
  touches.add(10 * kSecond, kPlace, {0.3, 0.1});
  const auto ahead = felt(touches, 11 * kSecond, kPlace);
  ASSERT_GE(ahead.size(), 5U);
  for (const ObstaclePoint& obstacle : ahead) {
    EXPECT_NEAR(obstacle.position.x(), 0.24, 1e-9);
    EXPECT_LE(std::abs(obstacle.position.y()), 0.2125 + 1e-9);
    EXPECT_FALSE(obstacle.is_known);
  }
  TouchMemory behind(testing::test_robot());
  behind.add(10 * kSecond, kPlace, {-0.15, 0.0});
  EXPECT_NEAR(felt(behind, 11 * kSecond, kPlace).front().position.x(), -0.331, 1e-9);
}

TEST(TouchMemory, LetsTheRobotLeaveButNotComeBack) {
  TouchMemory touches(testing::test_robot());
  touches.add(10 * kSecond, kPlace, {0.3, 0.0});
  const StopLogic stop_logic(testing::test_robot(), StopLogicParams{});
  const auto here = felt(touches, 11 * kSecond, kPlace);
  EXPECT_EQ(stop_logic.judge({0.3, 0.0}, testing::around(here), fresh()).twist.linear, 0.0);
  EXPECT_LT(stop_logic.judge({-0.15, 0.0}, testing::around(here), fresh()).twist.linear, -0.1);
  // a metre back it may drive on, and stops before the same place
  const auto from_afar = felt(touches, 20 * kSecond, kPlace * Pose2{-1.0, 0.0, 0.0});
  EXPECT_GT(stop_logic.judge({0.3, 0.0}, testing::around(from_afar), fresh()).twist.linear, 0.2);
  EXPECT_NEAR(from_afar.front().position.x(), 1.24, 1e-9);
}

TEST(TouchMemory, LearnsNothingFromATurnOnTheSpot) {
  TouchMemory touches(testing::test_robot());
  touches.add(10 * kSecond, kPlace, {0.0, 0.5});
  EXPECT_TRUE(felt(touches, 11 * kSecond, kPlace).empty());
}

TEST(TouchMemory, ForgetsAfterAWhileAndWhenOdometryJumps) {
  TouchMemory touches(testing::test_robot());
  touches.add(10 * kSecond, kPlace, {0.3, 0.0});
  EXPECT_FALSE(felt(touches, 69 * kSecond, kPlace).empty());
  EXPECT_TRUE(felt(touches, 71 * kSecond, kPlace).empty());
  EXPECT_TRUE(felt(touches, 5 * kSecond, kPlace).empty()) << "a clock that started anew";
  touches.clear();
  EXPECT_TRUE(felt(touches, 11 * kSecond, kPlace).empty());
}

TEST(TouchMemory, KeepsTheLatestOfMany) {
  TouchMemory touches(testing::test_robot());
  for (int i = 0; i < 27; ++i) {
    touches.add((10 + i) * kSecond, {static_cast<double>(i), 0.0, 0.0}, {0.3, 0.0});
  }
  const auto all = felt(touches, 37 * kSecond, {});
  EXPECT_NEAR(all.front().position.x(), 7.24, 1e-9);
  EXPECT_NEAR(all.back().position.x(), 26.24, 1e-9);
}

}  // namespace
}  // namespace luminav
