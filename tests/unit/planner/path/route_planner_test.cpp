#include "services/planner/path/route_planner.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/unit/planner/floor_plan.hpp"

namespace luminav {
namespace {

OccupancyGrid two_rooms() {
  OccupancyGrid grid = empty_room(10.0, 5.0);
  build_wall(grid, 5.0, 0.0, 5.2, 5.4);
  build_wall(grid, 5.0, 2.0, 5.2, 2.9, Prior::kFree);
  return grid;
}

RoutePlanner planner_for(const OccupancyGrid& grid, const RoutePlannerParams& params = {}) {
  RoutePlanner planner(params);
  planner.set_grid(grid, {});
  return planner;
}

TEST(RoutePlanner, PassesADoorInItsMiddle) {
  RoutePlanner planner = planner_for(two_rooms());
  const Route route = planner.plan({{2.0, 1.0}, {9.0, 4.0}, 0.1});
  ASSERT_EQ(route.outcome, RouteOutcome::kFound);
  for (const Eigen::Vector2d& point : route.points) {
    if (point.x() > 5.0 && point.x() < 5.2) {
      EXPECT_NEAR(point.y(), 2.45, 0.08);
    }
  }
  EXPECT_EQ(route.points.front(), Eigen::Vector2d(2.0, 1.0));
  EXPECT_EQ(route.points.back(), Eigen::Vector2d(9.0, 4.0));
}

TEST(RoutePlanner, TakesTheShortWayThroughNarrowDoorsWhateverTheRoomBeside) {
  // six doors of 0.8 m in a row, and a wide way round behind them that is half as long again
  OccupancyGrid grid = empty_room(16.0, 12.0);
  build_wall(grid, 1.0, 2.0, 15.0, 2.2);
  for (double x = 2.0; x <= 12.0; x += 2.0) {
    build_wall(grid, x, 0.0, x + 0.2, 2.2);
    build_wall(grid, x, 0.6, x + 0.2, 1.4, Prior::kFree);
  }
  RoutePlanner planner = planner_for(grid);
  const Route route = planner.plan({{1.4, 1.0}, {13.5, 1.0}, 0.1});
  ASSERT_EQ(route.outcome, RouteOutcome::kFound);
  EXPECT_LE(polyline_length(route.points), ConfigurationSpace::kMaxDetour * 12.1);
}

TEST(RoutePlanner, GoesRoundAKeepOutZone) {
  RoutePlannerParams params;
  const Polygon stairs = {{3.0, 0.0}, {5.0, 0.0}, {5.0, 3.0}, {3.0, 3.0}};
  params.space.zones = {{"stairs", ZoneKind::kKeepOut, stairs}};
  RoutePlanner planner = planner_for(empty_room(8.0, 5.0), params);
  const Route route = planner.plan({{1.0, 1.0}, {7.0, 1.0}, 0.1});
  ASSERT_EQ(route.outcome, RouteOutcome::kFound);
  for (const Eigen::Vector2d& point : route.points) {
    EXPECT_FALSE(contains(stairs, point));
    EXPECT_GT(distance_to_edge(stairs, point), 0.22) << point.transpose();
  }
  EXPECT_FALSE(planner.first_blocked(route.points, 0));
  EXPECT_EQ(planner.plan({{1.0, 1.0}, {4.0, 1.0}, 0.1}).outcome, RouteOutcome::kGoalBlocked);
}

/// Two corridors side by side between two halls; the lower one is a one-way zone.
RoutePlanner planner_with_lane(double direction, double lane_from = 4.0, double lane_to = 10.0) {
  OccupancyGrid grid = empty_room(14.0, 8.0);
  build_wall(grid, 4.0, 0.0, 10.0, 8.4);
  build_wall(grid, 4.0, 1.0, 10.0, 2.6, Prior::kFree);
  build_wall(grid, 4.0, 5.6, 10.0, 7.2, Prior::kFree);
  RoutePlannerParams params;
  params.space.zones = {{"lane",
                         ZoneKind::kOneWay,
                         {{lane_from, 0.8}, {lane_to, 0.8}, {lane_to, 2.8}, {lane_from, 2.8}},
                         0.2,
                         direction}};
  RoutePlanner planner(params);
  planner.set_grid(grid, {});
  return planner;
}

double highest(const Route& route) {
  double y = 0.0;
  for (const Eigen::Vector2d& point : route.points) {
    y = std::max(y, point.y());
  }
  return y;
}

TEST(RoutePlanner, TakesAOneWayZoneInItsDirectionOnly) {
  const RouteRequest east{{2.0, 1.8}, {12.0, 1.8}, 0.1};
  const RouteRequest west{{12.0, 1.8}, {2.0, 1.8}, 0.1};
  RoutePlanner planner = planner_with_lane(0.0);
  EXPECT_LT(highest(planner.plan(east)), 3.0);
  const Route round = planner.plan(west);
  ASSERT_EQ(round.outcome, RouteOutcome::kFound);
  EXPECT_GT(highest(round), 5.5);
  EXPECT_LT(highest(planner.plan(east)), 3.0) << "nothing of the way back is kept";
  RoutePlanner aslant = planner_with_lane(kPi - 0.6);
  EXPECT_GT(highest(aslant.plan(east)), 5.5);
  EXPECT_LT(highest(aslant.plan(west)), 3.0);
}

TEST(RoutePlanner, ReachesAGoalInAOneWayZoneFromItsBeginning) {
  RoutePlanner planner = planner_with_lane(0.0, 6.0, 8.0);
  const Route ahead = planner.plan({{5.0, 1.8}, {7.0, 1.8}, 0.1});
  ASSERT_EQ(ahead.outcome, RouteOutcome::kFound);
  EXPECT_LT(polyline_length(ahead.points), 3.0);
  const Route back = planner.plan({{9.0, 1.8}, {7.0, 1.8}, 0.1});
  ASSERT_EQ(back.outcome, RouteOutcome::kFound);
  EXPECT_GT(highest(back), 5.5) << "round by the other corridor";
  for (std::size_t i = 1; i < back.points.size(); ++i) {
    EXPECT_FALSE(planner.space().lanes().is_against(back.points[i - 1], back.points[i])) << i;
  }
}

TEST(RoutePlanner, FindsNoWayWhereOnlyAOneWayZoneLeadsBack) {
  OccupancyGrid grid = empty_room(14.0, 3.0);
  RoutePlannerParams params;
  params.space.zones = {{"lane", ZoneKind::kOneWay, {{4.0, 0.0}, {10.0, 0.0}, {10.0, 4.0}, {4.0, 4.0}}, 0.2, kPi}};
  for (const PlannerMode mode : {PlannerMode::kModern, PlannerMode::kPaper}) {
    params.mode = mode;
    RoutePlanner planner = planner_for(grid, params);
    EXPECT_EQ(planner.plan({{2.0, 1.8}, {12.0, 1.8}, 0.1}).outcome, RouteOutcome::kUnreachable);
    EXPECT_EQ(planner.plan({{12.0, 1.8}, {2.0, 1.8}, 0.1}).outcome, RouteOutcome::kFound);
  }
  params.largest_weighed = 10;  // as on a map too large for prices
  EXPECT_EQ(planner_for(grid, params).plan({{2.0, 1.8}, {12.0, 1.8}, 0.1}).outcome, RouteOutcome::kUnreachable);
}

TEST(RoutePlanner, LeadsOutOfAKeepOutZoneByAShortWayAndNotThroughItsWalls) {
  RoutePlannerParams params;
  const Polygon stairs = {{2.0, 0.0}, {8.0, 0.0}, {8.0, 4.0}, {2.0, 4.0}};
  params.space.zones = {{"stairs", ZoneKind::kKeepOut, stairs}};
  OccupancyGrid grid = empty_room(12.0, 8.0);
  build_wall(grid, 2.0, 2.9, 6.0, 3.1);  // inside the zone, north of the robot
  RoutePlanner planner = planner_for(grid, params);
  const Eigen::Vector2d robot{4.5, 2.3};
  const Route route = planner.plan({robot, {11.0, 7.0}, 0.1});
  ASSERT_EQ(route.outcome, RouteOutcome::kFound);
  double inside = 0.0;
  for (std::size_t i = 1; i < route.points.size(); ++i) {
    const Eigen::Vector2d& point = route.points[i];
    EXPECT_NE(grid.prior[grid.geometry.index(grid.geometry.cell_at(point))], Prior::kOccupied) << point.transpose();
    inside += contains(stairs, point) ? (point - route.points[i - 1]).norm() : 0.0;
  }
  EXPECT_LT(inside, 3.7);
  EXPECT_FALSE(planner.first_blocked(route.points, 0)) << "who is inside may leave";
}

TEST(RoutePlanner, FindsTheWayInPaperModeToo) {
  RoutePlannerParams params;
  params.mode = PlannerMode::kPaper;
  RoutePlanner planner = planner_for(two_rooms(), params);
  const Route route = planner.plan({{2.0, 1.0}, {9.0, 4.0}, 0.1});
  ASSERT_EQ(route.outcome, RouteOutcome::kFound);
  EXPECT_EQ(route.points.back(), Eigen::Vector2d(9.0, 4.0));
}

TEST(RoutePlanner, TellsWhyThereIsNoWay) {
  OccupancyGrid grid = two_rooms();
  build_wall(grid, 5.0, 2.0, 5.2, 2.9);
  RoutePlanner planner = planner_for(grid);
  const Route closed = planner.plan({{2.0, 1.0}, {9.0, 4.0}, 0.1});
  EXPECT_EQ(closed.outcome, RouteOutcome::kUnreachable);
  ASSERT_TRUE(closed.nearest_reachable);
  EXPECT_LT(closed.nearest_reachable->x(), 5.0);
  const Route beside_the_wall = planner.plan({{4.8, 1.0}, {9.0, 4.0}, 0.1});
  EXPECT_EQ(beside_the_wall.outcome, RouteOutcome::kUnreachable) << "the goal is shut off, not the robot";
  EXPECT_EQ(planner.plan({{2.0, 1.0}, {99.0, 4.0}, 0.1}).outcome, RouteOutcome::kGoalOutside);
  EXPECT_EQ(planner.plan({{-2.0, 1.0}, {2.0, 4.0}, 0.1}).outcome, RouteOutcome::kStartOutside);
  EXPECT_EQ(planner.plan({{2.0, 1.0}, {5.1, 1.0}, 0.1}).outcome, RouteOutcome::kGoalBlocked);
}

TEST(RoutePlanner, EndsNearABlockedGoalWithinItsTolerance) {
  RoutePlanner planner = planner_for(two_rooms());
  const Route route = planner.plan({{2.0, 1.0}, {4.8, 1.0}, 0.4});
  ASSERT_EQ(route.outcome, RouteOutcome::kFound);
  EXPECT_LE(route.goal_gap, 0.4);
  EXPECT_LE(route.goal_gap, 0.25) << "as near as can be";
  EXPECT_LT(route.points.back().x(), 4.8) << "on the side of the wall where the robot is";
}

TEST(RoutePlanner, LeadsOutFromBesideAnObstacle) {
  OccupancyGrid grid = two_rooms();
  RoutePlanner planner = planner_for(grid);
  const Route route = planner.plan({{4.85, 1.0}, {2.0, 4.0}, 0.1});
  ASSERT_EQ(route.outcome, RouteOutcome::kFound);
  for (const Eigen::Vector2d& point : route.points) {
    EXPECT_FALSE(planner.space().is_solid(grid.geometry.cell_at(point)));
  }
}

TEST(RoutePlanner, LeadsOutOfAPhantomUnderTheRobot) {
  OccupancyGrid grid = two_rooms();
  grid.evidence[grid.geometry.index(grid.geometry.cell_at({2.0, 2.0}))] = 50;
  RoutePlanner planner = planner_for(grid);
  EXPECT_EQ(planner.plan({{2.0, 2.0}, {4.0, 4.0}, 0.1}).outcome, RouteOutcome::kFound);
}

TEST(RoutePlanner, DoesNotLeadThroughAWallToEscape) {
  OccupancyGrid grid = two_rooms();
  build_wall(grid, 5.0, 2.0, 5.2, 2.9);
  RoutePlanner planner = planner_for(grid);
  const Route route = planner.plan({{4.9, 1.0}, {9.0, 4.0}, 0.1});
  EXPECT_NE(route.outcome, RouteOutcome::kFound);
}

TEST(RoutePlanner, KeepsClearOfWallsOnRandomPlans) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> x(0.6, 9.8);
  std::uniform_real_distribution<double> y(0.6, 4.8);
  OccupancyGrid grid = two_rooms();
  build_wall(grid, 2.0, 2.0, 2.6, 2.8);
  build_wall(grid, 7.0, 1.0, 7.5, 3.0);
  RoutePlanner planner = planner_for(grid);
  int found = 0;
  for (int i = 0; i < 200; ++i) {
    const RouteRequest request{{x(rng), y(rng)}, {x(rng), y(rng)}, 0.1};
    const bool both_free = !planner.space().is_blocked(grid.geometry.cell_at(request.start)) &&
                           !planner.space().is_blocked(grid.geometry.cell_at(request.goal));
    const Route route = planner.plan(request);
    if (!both_free) {
      continue;
    }
    ASSERT_EQ(route.outcome, RouteOutcome::kFound);
    ++found;
    EXPECT_FALSE(planner.first_blocked(route.points, 0));
    for (std::size_t k = 1; k < route.points.size(); ++k) {
      EXPECT_TRUE(is_clear(planner.space(), route.points[k - 1], route.points[k]));
      EXPECT_LE((route.points[k] - route.points[k - 1]).norm(), 0.25);
    }
  }
  EXPECT_GT(found, 100);
}

TEST(RoutePlanner, PlansTheSameFromTheSame) {
  RoutePlanner first = planner_for(two_rooms());
  RoutePlanner second = planner_for(two_rooms());
  const Route a = first.plan({{2.0, 1.0}, {9.0, 4.0}, 0.1});
  const Route b = second.plan({{2.0, 1.0}, {9.0, 4.0}, 0.1});
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i], b.points[i]);
  }
}

TEST(RoutePlanner, SaysWhereAPathIsBlocked) {
  OccupancyGrid grid = two_rooms();
  RoutePlanner planner = planner_for(grid);
  const Route route = planner.plan({{2.0, 2.45}, {9.0, 2.45}, 0.1});
  ASSERT_EQ(route.outcome, RouteOutcome::kFound);
  EXPECT_FALSE(planner.first_blocked(route.points, 0));
  grid.evidence[grid.geometry.index(grid.geometry.cell_at({7.0, 2.45}))] = 50;
  planner.set_grid(grid, {});
  const auto blocked = planner.first_blocked(route.points, 0);
  ASSERT_TRUE(blocked);
  EXPECT_NEAR(route.points[*blocked].x(), 6.85, 0.2);
}

TEST(RoutePlanner, PlansOnMapsTooLargeToWeighToo) {
  RoutePlannerParams params;
  params.largest_weighed = 0;
  OccupancyGrid grid = two_rooms();
  RoutePlanner planner = planner_for(grid, params);
  const Route route = planner.plan({{2.0, 1.0}, {9.0, 4.0}, 0.1});
  ASSERT_EQ(route.outcome, RouteOutcome::kFound);
  EXPECT_EQ(route.points.back(), Eigen::Vector2d(9.0, 4.0));
  EXPECT_FALSE(planner.first_blocked(route.points, 0));
  EXPECT_LT(route.cost, 1.1 * planner_for(grid).plan({{2.0, 1.0}, {9.0, 4.0}, 0.1}).cost);
  // beside an obstacle, into one, and into a closed room
  EXPECT_EQ(planner.plan({{5.3, 1.0}, {9.0, 4.0}, 0.1}).outcome, RouteOutcome::kFound);
  EXPECT_EQ(planner.plan({{2.0, 1.0}, {5.35, 1.0}, 0.3}).outcome, RouteOutcome::kFound);
  build_wall(grid, 5.0, 2.0, 5.2, 2.9);
  planner.set_grid(grid, {});
  EXPECT_EQ(planner.plan({{2.0, 1.0}, {9.0, 4.0}, 0.1}).outcome, RouteOutcome::kUnreachable);
}

// What is kept between plans must never show: obstacles come and go, the robot drives on, the goal changes.
void expect_the_same_with_what_was_kept(const RoutePlannerParams& params) {
  std::mt19937 rng(9);
  OccupancyGrid grid = two_rooms();
  RoutePlanner kept = planner_for(grid, params);
  std::uniform_real_distribution<double> along(0.6, 4.5);
  std::uniform_real_distribution<double> up(0.6, 4.6);
  std::uniform_int_distribution<int> column(4, 90);
  std::uniform_int_distribution<int> row(4, 45);
  int found = 0;
  for (int round = 0; round < 60; ++round) {
    const int left = column(rng);
    const int low = row(rng);
    const auto evidence = static_cast<std::int8_t>(round % 3 == 0 ? 0 : 50);
    for (int r = low; r < low + 4; ++r) {
      for (int c = left; c < left + 4; ++c) {
        grid.evidence[grid.geometry.index({c, r})] = evidence;
      }
    }
    const Eigen::Vector2d goal(9.0, round / 20 % 2 == 0 ? 4.0 : 1.0);
    const RouteRequest request{{along(rng), up(rng)}, goal, 0.1};
    kept.set_grid(grid, {});
    const Route route = kept.plan(request);
    const Route anew = planner_for(grid, params).plan(request);
    ASSERT_EQ(route.outcome, anew.outcome) << "round " << round;
    EXPECT_NEAR(route.cost, anew.cost, 1e-9) << "round " << round;
    found += route.outcome == RouteOutcome::kFound ? 1 : 0;
  }
  EXPECT_GT(found, 20);
}

TEST(RoutePlanner, GivesTheSameRouteWithAndWithoutWhatItKept) {
  expect_the_same_with_what_was_kept({});
}

TEST(RoutePlanner, GivesTheSameRouteWithAndWithoutWhatItKeptOnLargeMaps) {
  RoutePlannerParams params;
  params.largest_weighed = 0;
  expect_the_same_with_what_was_kept(params);
}

}  // namespace
}  // namespace luminav
