#include "services/controller/following/local_map.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

// 3 x 2 m, free, one wall cell at column 20, row 10: x 2.0..2.1, y 1.0..1.1
OccupancyGrid small_grid() {
  GridGeometry geometry;
  geometry.columns = 30;
  geometry.rows = 20;
  OccupancyGrid grid(geometry);
  std::fill(grid.prior.begin(), grid.prior.end(), Prior::kFree);
  grid.prior[geometry.index({20, 10})] = Prior::kOccupied;
  return grid;
}

TEST(LocalMap, GivesTheFaceOfAWallTowardsTheRobot) {
  const auto walls = known_walls(small_grid(), {1.5, 1.05, 0.0}, 1.5);
  ASSERT_EQ(walls.size(), 1U);
  EXPECT_NEAR(walls[0].x(), 0.5, 1e-9);
  EXPECT_NEAR(walls[0].y(), 0.0, 1e-9);
  EXPECT_TRUE(known_walls(small_grid(), {0.2, 1.05, 0.0}, 1.5).empty());
}

TEST(LocalMap, TurnsWallsIntoTheRobotsFrame) {
  const auto walls = known_walls(small_grid(), {1.5, 1.05, kPi / 2.0}, 1.5);
  ASSERT_EQ(walls.size(), 1U);
  EXPECT_NEAR(walls[0].x(), 0.0, 1e-9);
  EXPECT_NEAR(walls[0].y(), -0.5, 1e-9);
}

TEST(LocalMap, BearsARobotOutsideTheGrid) {
  EXPECT_TRUE(known_walls(small_grid(), {-50.0, 90.0, 0.0}, 1.5).empty());
}

TEST(LocalMap, MeasuresToTheCellNotToItsCentre) {
  EXPECT_TRUE(has_wall_near(small_grid(), {1.9, 1.05}, 0.11));
  EXPECT_FALSE(has_wall_near(small_grid(), {1.9, 1.05}, 0.09));
}

TEST(LocalMap, SeesWhetherTheRobotsWidthFits) {
  const OccupancyGrid grid = small_grid();
  EXPECT_TRUE(is_line_free(grid, {0.5, 0.5}, {2.8, 0.5}, {}));
  EXPECT_FALSE(is_line_free(grid, {0.5, 1.05}, {2.8, 1.05}, {}));
  EXPECT_FALSE(is_line_free(grid, {0.5, 0.85}, {2.8, 0.85}, {}));
  EXPECT_TRUE(is_line_free(grid, {0.5, 1.05}, {0.5, 1.05}, {}));
}

TEST(LocalMap, CountsEvidenceOnlyAboveItsThreshold) {
  OccupancyGrid grid = small_grid();
  grid.evidence[grid.geometry.index({10, 5})] = 15;
  EXPECT_TRUE(is_line_free(grid, {0.5, 0.55}, {1.5, 0.55}, {}));
  grid.evidence[grid.geometry.index({10, 5})] = 25;
  EXPECT_FALSE(is_line_free(grid, {0.5, 0.55}, {1.5, 0.55}, {}));
}

TEST(LocalMap, ADisputedWallIsNoWall) {
  OccupancyGrid grid = small_grid();
  grid.prior[grid.geometry.index({20, 10})] = Prior::kDisputed;
  EXPECT_FALSE(has_wall_near(grid, {2.05, 1.05}, 0.1));
}

}  // namespace
}  // namespace luminav
