#include "services/planner/path/side_keeping.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "services/planner/path/route_planner.hpp"
#include "tests/unit/planner/floor_plan.hpp"

namespace luminav {
namespace {

constexpr double kMiddle = 1.4;  // [m] of a corridor of 2.4 m between walls of 0.2 m

ConfigurationSpace space_of(const OccupancyGrid& grid) {
  return {{}, grid, {}};
}

Polyline line(double from, double to, double y = kMiddle) {
  return resampled({{from, y}, {to, y}}, 0.2);
}

/// The y of a path that leads along x, where it comes by.
double y_at(const Polyline& path, double x) {
  return std::min_element(path.begin(), path.end(),
                          [&](const auto& a, const auto& b) { return std::abs(a.x() - x) < std::abs(b.x() - x); })
      ->y();
}

TEST(KeepToSide, LeavesTheOtherSideOfACorridorToWhoComesTowardsIt) {
  const ConfigurationSpace space = space_of(empty_room(20.0, 2.4));
  const Polyline there = keep_to_side(space, KeepSide::kRight, line(2.0, 18.0));
  const Polyline back = keep_to_side(space, KeepSide::kRight, line(18.0, 2.0));
  for (double x = 6.0; x < 14.0; x += 1.0) {
    EXPECT_NEAR(y_at(there, x), kMiddle - 0.6, 0.1) << x;
    EXPECT_NEAR(y_at(back, x), kMiddle + 0.6, 0.1) << x;
    EXPECT_NEAR(y_at(keep_to_side(space, KeepSide::kLeft, line(2.0, 18.0)), x), kMiddle + 0.6, 0.1) << x;
  }
}

TEST(KeepToSide, KeepsEndsSpacingAndNearlyTheLength) {
  const ConfigurationSpace space = space_of(empty_room(20.0, 2.4));
  const Polyline before = line(2.0, 18.0);
  const Polyline after = keep_to_side(space, KeepSide::kRight, before);
  EXPECT_EQ(after.front(), before.front());
  EXPECT_EQ(after.back(), before.back());
  EXPECT_LT(polyline_length(after), 1.03 * polyline_length(before));
  for (std::size_t i = 1; i < after.size(); ++i) {
    EXPECT_LE((after[i] - after[i - 1]).norm(), 0.2 + 1e-9);
  }
}

TEST(KeepToSide, ChangesNothingWhereTwoCannotPassOrNoWallsAre) {
  const Polyline narrow = line(2.0, 18.0, 0.75);
  EXPECT_EQ(keep_to_side(space_of(empty_room(20.0, 1.1)), KeepSide::kRight, narrow), narrow);
  const Polyline hall = line(2.0, 18.0, 4.0);
  EXPECT_EQ(keep_to_side(space_of(empty_room(20.0, 8.0)), KeepSide::kRight, hall), hall);
  const Polyline any = line(2.0, 18.0);
  EXPECT_EQ(keep_to_side(space_of(empty_room(20.0, 2.4)), KeepSide::kNone, any), any);
}

TEST(KeepToSide, GoesTheLessToTheSideTheNarrowerACorridorIs) {
  double last = 0.02;
  for (const double width : {1.4, 1.6, 2.0}) {
    const double middle = 0.2 + 0.5 * width;
    const Polyline path = keep_to_side(space_of(empty_room(20.0, width)), KeepSide::kRight, line(2.0, 18.0, middle));
    const double offset = middle - y_at(path, 10.0);
    EXPECT_GT(offset, last) << width;
    last = offset;
  }
}

TEST(KeepToSide, DrivesStraightOnPastADoorThatStandsOpen) {
  OccupancyGrid grid = empty_room(20.0, 5.0);
  build_wall(grid, 0.0, 2.6, 20.4, 2.8);
  build_wall(grid, 9.5, 2.6, 10.5, 2.8, Prior::kFree);
  const Polyline path = keep_to_side(space_of(grid), KeepSide::kLeft, line(2.0, 18.0));
  for (double x = 6.0; x < 14.0; x += 0.2) {
    EXPECT_NEAR(y_at(path, x), kMiddle + 0.6, 0.1) << x;
  }
}

TEST(KeepToSide, ComesBackForADoorwayInItsWay) {
  OccupancyGrid grid = empty_room(20.0, 2.4);
  build_wall(grid, 9.9, 0.0, 10.1, 2.8);
  build_wall(grid, 9.9, 0.9, 10.1, 1.9, Prior::kFree);
  const ConfigurationSpace space = space_of(grid);
  const Polyline path = keep_to_side(space, KeepSide::kRight, line(2.0, 18.0));
  EXPECT_TRUE(is_clear(space, path));
  EXPECT_NEAR(y_at(path, 10.0), kMiddle, 0.2);
  EXPECT_LT(y_at(path, 6.0), kMiddle - 0.45);
  EXPECT_LT(y_at(path, 14.0), kMiddle - 0.45);
}

TEST(KeepToSide, PassesAThingThatStandsOnItsSide) {
  OccupancyGrid grid = empty_room(20.0, 2.4);
  build_wall(grid, 9.6, 0.2, 10.4, 1.0);
  const ConfigurationSpace space = space_of(grid);
  RoutePlannerParams params;
  params.shaping.keep_side = KeepSide::kRight;
  RoutePlanner planner(params);
  planner.set_grid(grid, {});
  const Route route = planner.plan({{2.0, kMiddle}, {18.0, kMiddle}});
  ASSERT_EQ(route.outcome, RouteOutcome::kFound);
  EXPECT_TRUE(is_clear(space, route.points));
  EXPECT_GT(y_at(route.points, 10.0), 1.35);
  EXPECT_LT(y_at(route.points, 5.0), kMiddle - 0.4);
}

TEST(KeepToSide, LeadsRoundACornerOnEitherSideAtNearlyTheSameLength) {
  OccupancyGrid grid = empty_room(14.0, 14.0);
  build_wall(grid, 2.6, 2.6, 14.4, 14.4);
  for (const bool turns_left : {true, false}) {
    RouteRequest request{{13.0, 1.4}, {1.4, 13.0}};
    if (turns_left) {
      std::swap(request.start, request.goal);
    }
    double length[2];
    for (const KeepSide side : {KeepSide::kNone, KeepSide::kRight}) {
      RoutePlannerParams params;
      params.shaping.keep_side = side;
      RoutePlanner planner(params);
      planner.set_grid(grid, {});
      const Route route = planner.plan(request);
      ASSERT_EQ(route.outcome, RouteOutcome::kFound);
      EXPECT_TRUE(is_clear(planner.space(), route.points));
      length[side == KeepSide::kNone ? 0 : 1] = polyline_length(route.points);
    }
    EXPECT_LE(length[1], 1.05 * length[0] + 1e-9) << turns_left;
  }
}

}  // namespace
}  // namespace luminav
