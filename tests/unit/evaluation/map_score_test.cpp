#include "tests/evaluation/judge/map_score.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>

namespace luminav {
namespace {

/// A room of 6 x 4 m with walls of 0.2 m, cells of 0.05 m.
WorldTruth room() {
  WorldTruth world;
  world.walls.geometry = GridGeometry{0.05, {0.0, 0.0}, 128, 88};
  world.walls.cells.assign(world.walls.geometry.size(), Prior::kFree);
  for (int row = 0; row < 88; ++row) {
    for (int column = 0; column < 128; ++column) {
      if (row < 4 || column < 4 || row >= 84 || column >= 124) {
        world.walls.cells[world.walls.geometry.index({column, row})] = Prior::kOccupied;
      }
    }
  }
  return world;
}

/// The live grid with free space all over the room and evidence for the left wall, its cells' centres at x.
OccupancyGrid evidence_at(double x) {
  OccupancyGrid grid(GridGeometry{0.1, {0.0, 0.0}, 64, 44});
  for (int row = 3; row < 41; ++row) {
    for (int column = 4; column < 60; ++column) {
      grid.evidence[grid.geometry.index({column, row})] = -40;
    }
    const Cell wall = grid.geometry.cell_at({x, 0.1 * row + 0.05});
    grid.evidence[grid.geometry.index({wall.column, wall.row})] = 60;
    const Cell opposite = grid.geometry.cell_at({6.4 - x, 0.1 * row + 0.05});
    grid.evidence[grid.geometry.index({opposite.column, opposite.row})] = 60;
  }
  return grid;
}

TEST(MapScore, MeasuresToTheFaceOfAWallNotToItsInside) {
  // the face is at x = 0.2; evidence in cells centred at 0.05, 0.15, 0.25 and 0.35
  EXPECT_NEAR(score_map(evidence_at(0.05), room(), {}).wall_median_m, 0.15, 0.01);
  EXPECT_NEAR(score_map(evidence_at(0.15), room(), {}).wall_median_m, 0.05, 0.01);
  EXPECT_NEAR(score_map(evidence_at(0.25), room(), {}).wall_median_m, 0.05, 0.01);
  EXPECT_NEAR(score_map(evidence_at(0.35), room(), {}).wall_median_m, 0.15, 0.01);
}

TEST(MapScore, FindsTheWallsThatTheRobotPassed) {
  TrailPoint point;
  point.truth = {1.5, 2.2, 0.0};
  const MapResult result = score_map(evidence_at(0.25), room(), {point});
  EXPECT_TRUE(result.measured);
  EXPECT_GT(result.wall_recall, 0.1);  // of left, upper and lower wall only the left one has evidence
  EXPECT_LT(result.wall_recall, 0.6);
  EXPECT_EQ(result.free_precision, 1.0);
}

TEST(MapScore, SaysHowMuchOfTheFloorIsKnown) {
  WorldTruth world = room();
  world.start = {1.5, 2.2, 0.0};
  OccupancyGrid grid = evidence_at(0.25);
  EXPECT_EQ(score_map(grid, world, {}).explored, 1.0);
  for (int row = 0; row < 44; ++row) {
    std::fill_n(grid.evidence.begin() + static_cast<std::ptrdiff_t>(grid.geometry.index({32, row})), 27, 0);
  }
  EXPECT_NEAR(score_map(grid, world, {}).explored, 0.5, 0.02);
  world.obstacles.push_back({.world_from_obstacle = Pose2{3.2, 2.2, 0.0}, .length = 0.2, .width = 4.2});
  EXPECT_NEAR(score_map(grid, world, {}).explored, 1.0, 0.02) << "what is behind cannot be got to";
}

TEST(MapScore, MeasuresNothingWithoutEvidence) {
  EXPECT_FALSE(score_map(OccupancyGrid(GridGeometry{0.1, {0.0, 0.0}, 64, 44}), room(), {}).measured);
}

}  // namespace
}  // namespace luminav
