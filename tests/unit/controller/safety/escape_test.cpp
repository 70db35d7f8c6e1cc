#include "services/controller/safety/escape.hpp"

#include <gtest/gtest.h>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

using testing::around;
using testing::wall;

const StopLogic kLogic(testing::test_robot(), {});

EscapeSituation situation(int attempt, bool may_back = true, bool by_unknown = false) {
  EscapeSituation result;
  result.attempt = attempt;
  result.may_back = may_back;
  result.by_unknown = by_unknown;
  return result;
}

TEST(Escape, BacksAwayFromAWallAhead) {
  const auto move = choose_escape(situation(0), around(wall({0.25, -0.5}, {0.25, 0.5})), kLogic);
  ASSERT_TRUE(move);
  EXPECT_LT(move->arcs.front().twist.linear, 0.0);
}

TEST(Escape, DoesNotBackWhereNothingLooks) {
  const auto move = choose_escape(situation(0, false), around(), kLogic);
  ASSERT_TRUE(move);
  EXPECT_GE(move->arcs.front().twist.linear, 0.0);
}

TEST(Escape, DoesNotBackIntoAWall) {
  const auto behind = wall({-0.40, -0.6}, {-0.40, 0.6});
  const auto move = choose_escape(situation(0), around(behind), kLogic);
  ASSERT_TRUE(move);
  for (const EscapeMove::Arc& arc : move->arcs) {
    EXPECT_TRUE(kLogic.is_free(arc.twist, arc.duration, around(behind)));
  }
}

TEST(Escape, TurnsTowardsTheOpenSide) {
  const auto left = wall({-1.0, 0.7}, {1.0, 0.7});
  const auto move = choose_escape(situation(1), around(left), kLogic);
  ASSERT_TRUE(move);
  EXPECT_LT(move->arcs.front().twist.angular, 0.0);
}

TEST(Escape, StepsAsideForPeople) {
  const auto move = choose_escape(situation(0, true, true), around(wall({0.32, -0.1}, {0.32, 0.1})), kLogic);
  ASSERT_TRUE(move);
  EXPECT_EQ(move->arcs.size(), 2U);
}

TEST(Escape, TriesSomethingElseTheNextTime) {
  EXPECT_NE(choose_escape(situation(0), around(), kLogic)->name, choose_escape(situation(1), around(), kLogic)->name);
}

// A corner of two walls, beside the robot and behind it, seen by one that heads 70 degrees away from the wall behind.
std::vector<ObstaclePoint> corner() {
  std::vector<ObstaclePoint> points = wall({-0.39, -0.60}, {-0.39, 1.5});
  const auto behind = wall({-0.39, -0.60}, {1.5, -0.60});
  points.insert(points.end(), behind.begin(), behind.end());
  const Pose2 robot_from_room = Pose2(0.0, 0.0, radians(70.0)).inverse();
  for (ObstaclePoint& point : points) {
    point.position = robot_from_room * point.position;
  }
  return points;
}

TEST(Escape, MakesRoomForATurnThatASwingingCornerForbids) {
  const Obstacles obstacles = around(corner());
  EscapeSituation stuck = situation(0);
  stuck.turn = radians(-60.0);
  ASSERT_FALSE(kLogic.is_free({0.0, -0.5}, radians(60.0) / 0.5, obstacles));
  const auto move = choose_escape(stuck, obstacles, kLogic);
  ASSERT_TRUE(move);
  const EscapeMove::Arc& arc = move->arcs.front();
  EXPECT_TRUE(kLogic.is_free(arc.twist, arc.duration, obstacles));
  const Obstacles there = obstacles.seen_from(drive_arc(arc.twist, arc.duration).inverse());
  const double left = stuck.turn - arc.twist.angular * arc.duration;
  EXPECT_TRUE(kLogic.is_free({0.0, std::copysign(0.5, left)}, std::abs(left) / 0.5, there));
}

TEST(Escape, MakesNoRoomForATurnThatPeopleForbid) {
  const Obstacles obstacles = around(corner());
  EscapeSituation stuck = situation(0);
  stuck.turn = radians(-60.0);
  const std::string room = choose_escape(stuck, obstacles, kLogic)->name;
  stuck.people_about = true;  // and a wall of the map in the way
  EXPECT_EQ(choose_escape(stuck, obstacles, kLogic)->name, room);
  stuck.by_unknown = true;
  EXPECT_NE(choose_escape(stuck, obstacles, kLogic)->name, room);
}

TEST(Escape, MakesNoRoomForATurnThatIsFree) {
  EscapeSituation free = situation(1);
  free.turn = radians(60.0);
  EXPECT_EQ(choose_escape(free, around(), kLogic)->name, choose_escape(situation(1), around(), kLogic)->name);
}

TEST(Escape, SaysSoWhereThereIsNone) {
  std::vector<ObstaclePoint> cage = wall({0.26, -0.26}, {0.26, 0.26});
  for (const auto& side :
       {wall({-0.35, -0.26}, {-0.35, 0.26}), wall({-0.35, 0.26}, {0.26, 0.26}), wall({-0.35, -0.26}, {0.26, -0.26})}) {
    cage.insert(cage.end(), side.begin(), side.end());
  }
  EXPECT_FALSE(choose_escape(situation(0), around(cage), kLogic));
}

}  // namespace
}  // namespace luminav
