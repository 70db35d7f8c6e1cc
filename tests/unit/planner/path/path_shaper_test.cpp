#include "services/planner/path/path_shaper.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "services/planner/path/route_planner.hpp"
#include "tests/unit/planner/floor_plan.hpp"

namespace luminav {
namespace {

/// Four lanes of 3 m one above the other, 48 m long, joined at alternate ends.
OccupancyGrid lanes() {
  OccupancyGrid grid = empty_room(48.0, 12.0);
  build_wall(grid, 0.0, 3.0, 46.0, 3.2);
  build_wall(grid, 2.0, 6.0, 48.2, 6.2);
  build_wall(grid, 0.0, 9.0, 46.0, 9.2);
  return grid;
}

/// Through all lanes, 0.6 m beside their lower walls, where no robot would drive; 190 m.
Polyline path_through() {
  return resampled({{1.0, 0.8}, {47.2, 0.8}, {47.2, 3.8}, {1.2, 3.8}, {1.2, 6.8}, {47.2, 6.8}, {47.2, 9.8}, {1.0, 9.8}},
                   0.1);
}

std::size_t same_at_the_end(const Polyline& a, const Polyline& b) {
  const auto last = std::mismatch(a.rbegin(), a.rend(), b.rbegin(), b.rend()).first;
  return static_cast<std::size_t>(last - a.rbegin());
}

TEST(PathShaper, ShapesAShortWayAsAWhole) {
  const ConfigurationSpace space({}, lanes(), {});
  const Polyline chain = resampled({{1.0, 0.8}, {47.2, 0.8}, {47.2, 3.8}}, 0.1);
  PathShaper shaper({});
  EXPECT_EQ(shaper.shape(space, chain), shape_path(space, {}, chain));
  EXPECT_EQ(shaper.kept(), 0U);
}

TEST(PathShaper, MakesNoKinkWhereSectionsMeet) {
  const ConfigurationSpace space({}, lanes(), {});
  const Polyline chain = path_through();
  const Polyline path = PathShaper({}).shape(space, chain);
  EXPECT_EQ(path.front(), chain.front());
  EXPECT_EQ(path.back(), chain.back());
  EXPECT_TRUE(is_clear(space, path));
  EXPECT_LT(cost_of(space, path), 1.005 * cost_of(space, shape_path(space, {}, chain)));
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const Eigen::Vector2d before = (path[i] - path[i - 1]).normalized();
    const Eigen::Vector2d behind = (path[i + 1] - path[i]).normalized();
    EXPECT_GT(before.dot(behind), 0.8) << "at point " << i;  // 37 degrees; the lanes' ends are rounded to less
    EXPECT_LE((path[i] - path[i - 1]).norm(), PathShapingParams{}.spacing + 1e-9);
  }
}

TEST(PathShaper, LeavesWhatIsFarAheadAsItWasWhenTheRobotHasDrivenOn) {
  const ConfigurationSpace space({}, lanes(), {});
  const Polyline chain = path_through();
  PathShaper shaper({});
  const Polyline first = shaper.shape(space, chain);
  const Polyline later = shaper.shape(space, Polyline(chain.begin() + 37, chain.end()));
  EXPECT_GE(same_at_the_end(first, later), 500U);  // of 0.2 m
}

TEST(PathShaper, ForgetsOnlyWhatLiesNearAChange) {
  OccupancyGrid grid = lanes();
  ConfigurationSpace space({}, grid, {});
  PathShaper shaper({});
  const Polyline before = shaper.shape(space, path_through());
  const std::size_t pieces = shaper.kept();
  build_wall(grid, 20.0, 1.5, 20.5, 2.0);  // in the first lane
  shaper.forget(space.geometry(), space.update(grid, {}).window);
  EXPECT_LT(shaper.kept(), pieces);
  EXPECT_GE(shaper.kept(), pieces - 3);
  const Polyline after = shaper.shape(space, path_through());
  EXPECT_EQ(after, PathShaper({}).shape(space, path_through()));
  EXPECT_NE(after, before);
  EXPECT_GE(same_at_the_end(before, after), 500U);
}

TEST(RoutePlanner, GivesTheSameLongRouteWithAndWithoutWhatItKept) {
  OccupancyGrid grid = lanes();
  for (const std::size_t largest_weighed : {std::size_t{2'000'000}, std::size_t{0}}) {
    RoutePlannerParams params;
    params.largest_weighed = largest_weighed;
    RoutePlanner kept(params);
    for (int round = 0; round < 12; ++round) {
      const RouteRequest request{{1.0 + 0.3 * round, 1.2}, {1.2, 10.5}, 0.1};
      build_wall(grid, 3.0 * round, 4.0, 3.0 * round + 0.5, 4.6, round % 3 == 2 ? Prior::kFree : Prior::kOccupied);
      kept.set_grid(grid, {});
      RoutePlanner anew(params);
      anew.set_grid(grid, {});
      const Route route = kept.plan(request);
      ASSERT_EQ(route.outcome, RouteOutcome::kFound);
      ASSERT_GT(polyline_length(route.points), 150.0);
      EXPECT_EQ(route.points, anew.plan(request).points) << "round " << round;
    }
  }
}

}  // namespace
}  // namespace luminav
