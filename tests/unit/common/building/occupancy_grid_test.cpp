#include "services/common/building/occupancy_grid.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace luminav {
namespace {

TEST(GridGeometry, HasNoCellForWhatIsFarAwayOrNowhere) {
  const GridGeometry geometry{0.1, {0.0, 0.0}, 10, 10};
  const double nowhere = std::numeric_limits<double>::quiet_NaN();
  for (const double far : {1e12, 1e300, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(geometry.cell_at({far, -far}), (Cell{1'000'000'000, -1'000'000'000}));
  }
  EXPECT_EQ(geometry.cell_at({nowhere, 0.05}), (Cell{-1'000'000'000, 0}));
  EXPECT_EQ(geometry.cell_at({-0.01, 0.99}), (Cell{-1, 9}));
}

TEST(GridGeometry, TurnsMetresIntoCellsAndBack) {
  const GridGeometry grid{0.1, {-1.0, 2.0}, 30, 20};
  EXPECT_EQ(grid.cell_at({-1.0, 2.0}), (Cell{0, 0}));
  EXPECT_EQ(grid.cell_at({-1.01, 2.0}), (Cell{-1, 0}));
  EXPECT_EQ(grid.cell_at({1.99, 3.99}), (Cell{29, 19}));
  EXPECT_FALSE(grid.contains(grid.cell_at({2.01, 3.0})));
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      EXPECT_EQ(grid.cell_at(grid.centre_of({column, row})), (Cell{column, row}));
    }
  }
}

TEST(PriorMap, IsUnknownOutside) {
  PriorMap map{{0.5, {0.0, 0.0}, 2, 1}, {Prior::kFree, Prior::kOccupied}};
  EXPECT_EQ(map.at({0.2, 0.2}), Prior::kFree);
  EXPECT_EQ(map.at({0.7, 0.2}), Prior::kOccupied);
  EXPECT_EQ(map.at({-0.1, 0.2}), Prior::kUnknown);
  EXPECT_EQ(map.at({0.2, 0.6}), Prior::kUnknown);
}

TEST(Resample, NeverLosesAWall) {
  PriorMap fine{{0.05, {0.0, 0.0}, 5, 2}, std::vector<Prior>(10, Prior::kFree)};
  fine.cells[3] = Prior::kOccupied;
  fine.cells[8] = Prior::kUnknown;
  const PriorMap coarse = resample(fine, 0.1);
  ASSERT_EQ(coarse.geometry.columns, 3);
  ASSERT_EQ(coarse.geometry.rows, 1);
  EXPECT_EQ(coarse.cells[0], Prior::kFree);
  EXPECT_EQ(coarse.cells[1], Prior::kOccupied);
  EXPECT_EQ(coarse.cells[2], Prior::kFree);
}

TEST(Resample, KeepsAMapOfTheSameResolution) {
  const PriorMap map{{0.1, {1.0, 1.0}, 1, 1}, {Prior::kUnknown}};
  EXPECT_EQ(resample(map, 0.1).cells, map.cells);
}

TEST(OccupancyGrid, CountsPartlyFilledTiles) {
  const OccupancyGrid grid(GridGeometry{0.1, {0.0, 0.0}, 65, 64});
  EXPECT_EQ(grid.tile_columns(), 2);
  EXPECT_EQ(grid.tile_rows(), 1);
}

}  // namespace
}  // namespace luminav
