#include "services/planner/holding/blockage_hold.hpp"

#include <gtest/gtest.h>

#include "tests/unit/planner/floor_plan.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kSecond = 1'000'000;  // [us]

/// Two rooms with a door of 0.9 m at (3.1, 2.25), in which something stands.
class BlockageHoldTest : public testing::Test {
 protected:
  BlockageHoldTest() : grid(empty_room(6.0, 4.0)), map({}), stops({}), hold({}, {{4, {3.1, 2.25, 0.5 * kPi}, 0.9}}) {
    build_wall(grid, 3.0, 0.0, 3.2, 4.4);
    build_wall(grid, 3.0, 1.8, 3.2, 2.7, Prior::kFree);
    block(30);
    map.change(grid, 1, 1);
    map.refresh();
    GoalRequest goal;
    goal.stops.resize(1);
    stops.begin(goal, 0);
  }
  void block(int column) {
    for (int row = 18; row < 27; ++row) {
      grid.evidence[grid.geometry.index({column, row})] = 50;
    }
  }
  /// Waits before the door, coming from `x` [m].
  PathOrder begin(double x) {
    const Route path = map.plan_by_building({{x, 2.25}, {5.0, 2.25}, 0.1});
    return hold.begin(map, path.points, map.first_blocked(path.points).value(), 4.0, kSecond);
  }
  void stand_at(const Pose2& pose, std::int64_t now) {
    robot = pose;
    Situation situation;
    situation.now = now;
    situation.world_from_robot = pose;
    hold.update(IssuedPath{}, situation);
  }

  OccupancyGrid grid;
  RouteMap map;
  StopList stops;
  BlockageHold hold;
  Pose2 robot;
};

TEST_F(BlockageHoldTest, DrivesUpToSomeDistanceBeforeTheBlockage) {
  const PathOrder order = begin(0.8);
  ASSERT_FALSE(order.points.empty());
  EXPECT_NEAR(order.points.back().x(), 2.1, 0.25);
  EXPECT_FALSE(order.theta);
  EXPECT_EQ(hold.reason().substr(0, 26), "door at (3.1, 2.2) is bloc");
}

TEST_F(BlockageHoldTest, StandsWhereItIsWhenThatIsNearEnough) {
  EXPECT_TRUE(begin(2.1).points.empty());
}

TEST_F(BlockageHoldTest, CountsTheWaitFromWhenItStands) {
  IssuedPath path;
  path.issue(begin(0.8), stops, 0);
  Situation situation;
  situation.now = 2 * kSecond;
  situation.world_from_robot = {0.8, 2.25, 0.0};
  hold.update(path, situation);
  EXPECT_FALSE(hold.has_waited(15 * kSecond)) << "it is on its way";
  situation.now = 5 * kSecond;
  situation.world_from_robot = {path.points().back().x(), 2.25, 0.0};
  hold.update(path, situation);
  EXPECT_FALSE(hold.has_waited(14 * kSecond));
  EXPECT_TRUE(hold.has_waited(15 * kSecond));
  EXPECT_TRUE(hold.has_waited_in_vain(105 * kSecond));
}

TEST_F(BlockageHoldTest, TakesOnlyAShortDetourAtOnce) {
  (void)begin(0.8);
  EXPECT_FALSE(hold.is_long(9.0));  // 1.5 times 4 m and 3 m
  EXPECT_TRUE(hold.is_long(9.1));
}

TEST_F(BlockageHoldTest, FacesWhatBlocksAfterAWhileUnlessItDoesAlready) {
  (void)begin(2.1);
  EXPECT_FALSE(hold.face_blockage(map, {2.1, 2.25, 1.0}, 9 * kSecond));
  EXPECT_FALSE(hold.face_blockage(map, {2.1, 2.25, 0.0}, 11 * kSecond));
  const auto turn = hold.face_blockage(map, {2.1, 2.25, 1.0}, 11 * kSecond);
  ASSERT_TRUE(turn);
  EXPECT_NEAR(*turn->theta, 0.0, 0.2);
  EXPECT_FALSE(hold.face_blockage(map, {2.1, 2.25, 1.0}, 12 * kSecond)) << "it is turning";
}

TEST_F(BlockageHoldTest, MakesWayForWhoComesNearer) {
  (void)begin(2.1);
  EXPECT_FALSE(hold.make_way(map, {2.1, 2.25, 0.0}, kSecond)) << "a thing stays where it is";
  grid.evidence.assign(grid.evidence.size(), 0);
  block(26);
  map.change(grid, 1, 1);
  map.refresh();
  const auto beside = hold.make_way(map, {2.1, 2.25, 0.0}, kSecond);
  ASSERT_TRUE(beside);
  EXPECT_GT(std::abs(beside->points.back().y() - 2.25), 0.85);
}

TEST_F(BlockageHoldTest, KeepsWhatTheSonarsHaveDrawnRoundTheBlockage) {
  (void)begin(0.8);
  EXPECT_EQ(hold.evidence(map).size(), 9U) << "the cells in the door; walls need no keeping";
}

}  // namespace
}  // namespace luminav
