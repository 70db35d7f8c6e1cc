#include "services/planner/goals/route_map.hpp"

#include <gtest/gtest.h>

#include "tests/unit/planner/floor_plan.hpp"

namespace luminav {
namespace {

/// Two rooms with a door of 0.9 m between them, in which something stands.
OccupancyGrid rooms_with_a_blocked_door() {
  OccupancyGrid grid = empty_room(6.0, 4.0);
  build_wall(grid, 3.0, 0.0, 3.2, 4.4);
  build_wall(grid, 3.0, 1.8, 3.2, 2.7, Prior::kFree);
  for (int row = 18; row < 27; ++row) {
    grid.evidence[grid.geometry.index({30, row})] = 50;
  }
  return grid;
}

const RouteRequest kThroughTheDoor{{1.0, 2.2}, {5.0, 2.2}, 0.1};

TEST(RouteMap, IsCompleteWithAllTiles) {
  const OccupancyGrid grid = empty_room(2.0, 2.0);
  RouteMap map({});
  EXPECT_FALSE(map.is_complete());
  map.change(grid, 3, 4);
  EXPECT_FALSE(map.is_complete());
  map.change(grid, 4, 4);
  EXPECT_TRUE(map.is_complete());
}

TEST(RouteMap, TellsWhatSonarsHaveDrawnFromTheBuilding) {
  const OccupancyGrid grid = rooms_with_a_blocked_door();
  RouteMap map({});
  map.change(grid, 1, 1);
  map.refresh();
  EXPECT_NE(map.plan(kThroughTheDoor).outcome, RouteOutcome::kFound);
  const Route by_building = map.plan_by_building(kThroughTheDoor);
  ASSERT_EQ(by_building.outcome, RouteOutcome::kFound);
  const std::optional<std::size_t> blocked = map.first_blocked(by_building.points);
  ASSERT_TRUE(blocked);
  EXPECT_NEAR(by_building.points[*blocked].x(), 2.8, 0.25);
}

TEST(RouteMap, PlansRoundWhatIsSuspectedUntilItIsDropped) {
  OccupancyGrid grid = empty_room(6.0, 4.0);
  build_wall(grid, 3.0, 0.0, 3.2, 4.4);
  build_wall(grid, 3.0, 1.8, 3.2, 2.7, Prior::kFree);
  RouteMap map({});
  map.change(grid, 1, 1);
  map.suspect({{3.1, 2.25}, 0.3}, 1000);
  map.refresh();
  EXPECT_NE(map.plan(kThroughTheDoor).outcome, RouteOutcome::kFound);
  EXPECT_FALSE(map.has_changed());
  map.expire_suspects(1000);
  EXPECT_TRUE(map.has_changed());
  map.refresh();
  EXPECT_EQ(map.plan(kThroughTheDoor).outcome, RouteOutcome::kFound);
}

TEST(RouteMap, CountsWhatNobodyHasSeenThreeTimes) {
  OccupancyGrid grid = empty_room(6.0, 4.0);
  build_wall(grid, 3.0, 0.0, 6.4, 4.4, Prior::kUnknown);
  RouteMap map({});
  map.change(grid, 1, 1);
  EXPECT_NEAR(map.length_with_unknown({{1.0, 2.0}, {2.0, 2.0}, {4.0, 2.0}}), 1.0 + 3.0 * 2.0, 1e-9);
}

}  // namespace
}  // namespace luminav
