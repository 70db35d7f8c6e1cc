#include "services/planner/holding/blockage.hpp"

#include <gtest/gtest.h>

#include "tests/unit/planner/floor_plan.hpp"

namespace luminav {
namespace {

TEST(Blockage, MeasuresWhatADoorLeavesFree) {
  OccupancyGrid grid = empty_room(6.0, 4.0);
  build_wall(grid, 3.0, 0.0, 3.2, 4.4);
  build_wall(grid, 3.0, 1.8, 3.2, 2.7, Prior::kFree);
  for (int row = 18; row < 23; ++row) {  // 0.5 of 0.9 m
    grid.evidence[grid.geometry.index({30, row})] = 50;
  }
  const ConfigurationSpace space({}, grid, {});
  const Polyline path = {{2.0, 2.25}, {2.5, 2.25}, {3.0, 2.25}, {3.5, 2.25}};
  const Blockage blockage = measure_blockage(space, {{4, {3.1, 2.25, 0.5 * kPi}, 0.9}}, path, 2, 0.6);
  EXPECT_TRUE(blockage.is_door);
  EXPECT_NEAR(blockage.free_width, 0.4, 0.05);
  EXPECT_EQ(blockage.sentence(), "door at (3.1, 2.2) is blocked, 0.4 m free, need 0.6 m");
}

TEST(Blockage, MeasuresAcrossTheWayWhereNoDoorIs) {
  OccupancyGrid grid = empty_room(8.0, 1.4);
  for (int row = 2; row < 13; ++row) {  // 1.1 of 1.4 m
    grid.evidence[grid.geometry.index({40, row})] = 50;
  }
  const ConfigurationSpace space({}, grid, {});
  Polyline path;
  for (int i = 0; i < 30; ++i) {
    path.emplace_back(1.0 + 0.2 * i, 0.9);
  }
  const Blockage blockage = measure_blockage(space, {}, path, 14, 0.6);
  EXPECT_FALSE(blockage.is_door);
  EXPECT_NEAR(blockage.free_width, 0.3, 0.05);
}

TEST(Blockage, SaysWhatTheSonarsHaveDrawnInTheWay) {
  OccupancyGrid grid = empty_room(6.0, 2.0);
  build_wall(grid, 2.0, 0.0, 2.2, 1.0);  // of the building, beside the way
  grid.evidence[grid.geometry.index(grid.geometry.cell_at({4.05, 1.55}))] = 50;
  grid.evidence[grid.geometry.index(grid.geometry.cell_at({4.45, 1.35}))] = 50;
  const ConfigurationSpace space({}, grid, {});
  Polyline path;
  for (int i = 0; i < 25; ++i) {
    path.emplace_back(0.6 + 0.2 * i, 1.35);
  }
  const auto place = what_blocks(space, grid, path, 0.30);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->x(), 4.05, 1e-6);
  EXPECT_NEAR(place->y(), 1.55, 1e-6);
  const ConfigurationSpace suspected({}, empty_room(6.0, 2.0), {{{4.0, 1.35}, 0.3}});
  Polyline in_it = path;
  in_it.erase(in_it.begin(), std::find_if(in_it.begin(), in_it.end(), [](const auto& p) { return p.x() > 3.9; }));
  in_it.erase(in_it.begin() + 1, in_it.end());
  EXPECT_FALSE(what_blocks(space, grid, in_it, 0.30)) << "what is beside the robot itself is not in its way";
  EXPECT_FALSE(what_blocks(suspected, empty_room(6.0, 2.0), path, 0.30)) << "no sonar drew it";
}

}  // namespace
}  // namespace luminav
