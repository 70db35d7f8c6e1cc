#include "services/planner/path/path_shaping.hpp"

#include <gtest/gtest.h>

#include "tests/unit/planner/floor_plan.hpp"

namespace luminav {
namespace {

TEST(Resampled, KeepsEndsAndSpacing) {
  const Polyline line = resampled({{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.05}}, 0.2);
  EXPECT_EQ(line.front(), Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(line.back(), Eigen::Vector2d(1.0, 1.05));
  for (std::size_t i = 1; i < line.size(); ++i) {
    EXPECT_LE((line[i] - line[i - 1]).norm(), 0.2 + 1e-9);
  }
  EXPECT_EQ(line.size(), 12U);  // 2.05 m in 11 pieces
}

TEST(Resampled, GivesTwoPointsOfOnePlace) {
  EXPECT_EQ(resampled({{1.0, 2.0}}, 0.2).size(), 2U);
  EXPECT_EQ(resampled({{1.0, 2.0}, {1.0, 2.0}}, 0.2).size(), 2U);
}

TEST(ShapePath, MakesAStaircaseStraight) {
  const ConfigurationSpace space({}, empty_room(8.0, 8.0), {});
  Polyline stairs;
  for (int i = 0; i <= 20; ++i) {  // two right, one up
    stairs.emplace_back(2.0 + 0.2 * i, 3.0 + 0.1 * i);
    stairs.emplace_back(2.1 + 0.2 * i, 3.0 + 0.1 * i);
  }
  const Polyline shaped = shape_path(space, {}, stairs);
  EXPECT_NEAR(polyline_length(shaped), (stairs.back() - stairs.front()).norm(), 0.01);
  EXPECT_EQ(shaped.front(), stairs.front());
  EXPECT_EQ(shaped.back(), stairs.back());
}

TEST(ShapePath, MovesToTheMiddleOfACorridor) {
  const ConfigurationSpace space({}, empty_room(8.0, 2.0), {});
  Polyline beside_the_wall;
  for (int i = 0; i <= 60; ++i) {
    beside_the_wall.emplace_back(1.0 + 0.1 * i, i == 0 || i == 60 ? 1.2 : 0.65);
  }
  const Polyline shaped = shape_path(space, {}, beside_the_wall);
  EXPECT_NEAR(shaped[shaped.size() / 2].y(), 1.2, 0.16);  // at least 80 % of the clearance there is
}

TEST(ShapePath, NeverCutsThroughAnObstacle) {
  OccupancyGrid grid = empty_room(6.0, 6.0);
  build_wall(grid, 2.0, 0.0, 2.4, 4.0);
  const ConfigurationSpace space({}, grid, {});
  const Polyline round = {{1.0, 1.0}, {1.0, 5.0}, {4.0, 5.0}, {4.0, 1.0}};
  const Polyline shaped = shape_path(space, {}, resampled(round, 0.1));
  for (std::size_t i = 1; i < shaped.size(); ++i) {
    EXPECT_TRUE(is_clear(space, shaped[i - 1], shaped[i]));
  }
}

TEST(ShapePath, CutsNoCornerWhereverItsPiecesBegin) {
  OccupancyGrid grid = empty_room(6.0, 6.0);
  build_wall(grid, 2.0, 0.0, 2.1, 4.0);
  const ConfigurationSpace space({}, grid, {});
  PathShapingParams params;
  params.push = 0.0;  // what cuts a corner at first is not pushed out of it
  // as near to the corners as the robot may come
  for (double start = 1.0; start < 1.85; start += 0.05) {
    const Polyline round = {{1.65, start}, {1.65, 4.35}, {2.45, 4.35}, {2.45, 2.0}};
    ASSERT_TRUE(is_clear(space, round)) << "the way itself";
    EXPECT_TRUE(is_clear(space, shape_path(space, params, resampled(round, 0.05)))) << "from y = " << start;
  }
}

TEST(CostOf, IsTheLengthWhereNothingIsNear) {
  const ConfigurationSpace space({}, empty_room(8.0, 8.0), {});
  EXPECT_NEAR(cost_of(space, {{3.0, 4.0}, {5.0, 4.0}}), 2.0, 1e-9);
  EXPECT_GT(cost_of(space, {{3.0, 0.7}, {5.0, 0.7}}), 2.3);
}

}  // namespace
}  // namespace luminav
