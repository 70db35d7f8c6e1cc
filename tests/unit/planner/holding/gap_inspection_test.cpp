#include "services/planner/holding/gap_inspection.hpp"

#include <gtest/gtest.h>

#include "tests/unit/planner/floor_plan.hpp"

namespace luminav {
namespace {

const RouteRequest kThroughTheDoor{{1.0, 2.2}, {5.0, 2.2}, 0.1};

/// A map that the robot draws itself: a wall, and a door of 0.9 m that evidence of 1.5 log-odds closes.
class GapInspectionTest : public testing::Test {
 protected:
  GapInspectionTest() : grid(empty_room(6.0, 4.0)), map(params()) {
    build_wall(grid, 3.0, 0.0, 3.2, 4.4);
    build_wall(grid, 3.0, 1.8, 3.2, 2.7, Prior::kFree);
    for (int row = 18; row < 27; ++row) {
      grid.evidence[grid.geometry.index({30, row})] = static_cast<std::int8_t>(1.5 * kEvidencePerLogOdds);
    }
    map.change(grid, 1, 1);
    map.refresh();
  }
  static RoutePlannerParams params(bool unknown_is_free = true) {
    RoutePlannerParams params;
    params.space.unknown_is_free = unknown_is_free;
    return params;
  }

  OccupancyGrid grid;
  RouteMap map;
  GapInspection gaps;
};

TEST_F(GapInspectionTest, ChoosesADoorThatUnsureEvidenceCloses) {
  const std::optional<Gap> gap = gaps.choose(map, kThroughTheDoor, map.plan(kThroughTheDoor));
  ASSERT_TRUE(gap);
  EXPECT_NEAR(gap->path[gap->blocked_at].x(), 2.8, 0.3);
}

TEST_F(GapInspectionTest, LooksAtEachGapTwiceWhereNoOtherPathLeads) {
  const Route route = map.plan(kThroughTheDoor);
  ASSERT_NE(route.outcome, RouteOutcome::kFound);
  EXPECT_TRUE(gaps.choose(map, kThroughTheDoor, route));
  EXPECT_TRUE(gaps.choose(map, kThroughTheDoor, route)) << "from elsewhere it may look otherwise";
  EXPECT_FALSE(gaps.choose(map, kThroughTheDoor, route));
  gaps.reset();
  EXPECT_TRUE(gaps.choose(map, kThroughTheDoor, route));
}

TEST_F(GapInspectionTest, LeavesTheBuildingsWallsToTheBuildingsMap) {
  RouteMap of_building(params(false));
  of_building.change(grid, 1, 1);
  of_building.refresh();
  EXPECT_FALSE(gaps.choose(of_building, kThroughTheDoor, of_building.plan(kThroughTheDoor)));
}

TEST_F(GapInspectionTest, DropsWhatIsSuspectedBeforeAnythingIsLookedAt) {
  map.suspect({{3.1, 2.25}, 0.3}, 1000);
  map.refresh();
  EXPECT_FALSE(gaps.choose(map, kThroughTheDoor, map.plan(kThroughTheDoor)));
}

}  // namespace
}  // namespace luminav
