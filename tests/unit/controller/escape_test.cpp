#include "services/controller/escape.hpp"

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
