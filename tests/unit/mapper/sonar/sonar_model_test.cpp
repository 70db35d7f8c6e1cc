#include "services/mapper/sonar/sonar_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace luminav {
namespace {

GridGeometry hundred() {
  return {0.1, {-5.0, -5.0}, 100, 100};
}

SliceRanges unlimited() {
  SliceRanges ranges;
  ranges.fill(100.0);
  return ranges;
}

TEST(RowsOfSector, TakesTheCellsWhoseCentreLiesInside) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> place(-6.0, 6.0);
  std::uniform_real_distribution<double> heading(-kPi, kPi);
  std::uniform_real_distribution<double> radius(0.3, 4.0);
  const GridGeometry geometry = hundred();
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d apex(place(rng), place(rng));
    const double theta = heading(rng);
    const double reach = radius(rng);
    const double half = radians(15.0);
    const SectorRows rows = rows_of_sector(geometry, {apex, theta - half, theta + half, reach});
    for (int row = 0; row < geometry.rows; ++row) {
      const int k = row - rows.first_row;
      const bool has_row = k >= 0 && k < static_cast<int>(rows.columns.size());
      const ColumnRange columns = has_row ? rows.columns[static_cast<std::size_t>(k)] : ColumnRange{};
      for (int column = 0; column < geometry.columns; ++column) {
        const Eigen::Vector2d offset = geometry.centre_of({column, row}) - apex;
        const double off_axis = std::abs(wrap_angle(std::atan2(offset.y(), offset.x()) - theta));
        const bool inside = column >= columns.first && column <= columns.last;
        if (offset.norm() < 0.995 * reach && off_axis < half - 1e-6) {
          EXPECT_TRUE(inside);
        } else if (offset.norm() > reach || off_axis > half + 1e-6) {
          EXPECT_FALSE(inside);
        }
      }
    }
  }
}

TEST(FreeSpaceModel, StopsBeforeTheReading) {
  OccupancyGrid grid(hundred());
  FreeSpaceModel model(SonarModelParams{});
  model.apply({{0.0, 0.0, 0.0}, 2.0, true}, unlimited(), grid);
  const auto evidence = [&](double x, double y) {
    return grid.evidence[grid.geometry.index(grid.geometry.cell_at({x, y}))];
  };
  EXPECT_LT(evidence(1.05, 0.05), 0);
  EXPECT_LT(evidence(1.75, 0.05), 0);
  EXPECT_EQ(evidence(1.95, 0.05), 0);
  EXPECT_EQ(evidence(-0.15, 0.05), 0);
  EXPECT_EQ(evidence(1.05, 0.55), 0) << "outside the cone";
}

TEST(FreeSpaceModel, VotesMoreInTheMiddleOfTheCone) {
  OccupancyGrid grid(hundred());
  FreeSpaceModel model(SonarModelParams{});
  model.apply({{0.0, 0.0, 0.0}, 2.5, true}, unlimited(), grid);
  EXPECT_LT(grid.evidence[grid.geometry.index(grid.geometry.cell_at({1.85, 0.05}))],
            grid.evidence[grid.geometry.index(grid.geometry.cell_at({1.85, 0.42}))]);
}

TEST(FreeSpaceModel, TakesAReadingWithoutEchoForDoubtAndNotForProof) {
  OccupancyGrid grid(hundred());
  FreeSpaceModel model(SonarModelParams{});
  const std::size_t box = grid.geometry.index(grid.geometry.cell_at({1.05, 0.05}));
  const std::size_t nothing = grid.geometry.index(grid.geometry.cell_at({1.55, 0.05}));
  grid.evidence[box] = 50;
  model.apply({{0.0, 0.0, 0.0}, 5.0, false}, unlimited(), grid);
  EXPECT_LT(grid.evidence[box], 50);
  for (int i = 0; i < 100; ++i) {
    model.apply({{0.0, 0.0, 0.0}, 5.0, false}, unlimited(), grid);
  }
  EXPECT_EQ(grid.evidence[box], 0);
  EXPECT_EQ(grid.evidence[nothing], 0);
}

TEST(FreeSpaceModel, NeverFallsBelowItsClamp) {
  OccupancyGrid grid(hundred());
  const SonarModelParams params;
  FreeSpaceModel model(params);
  for (int i = 0; i < 500; ++i) {
    model.apply({{0.0, 0.0, 1.0}, 3.0, true}, unlimited(), grid);
  }
  EXPECT_EQ(*std::min_element(grid.evidence.begin(), grid.evidence.end()), to_evidence(params.min_log_odds));
}

TEST(FreeSpaceModel, LooksIntoEachSliceOnlyAsFarAsItsLimit) {
  OccupancyGrid grid(hundred());
  FreeSpaceModel model(SonarModelParams{});
  SliceRanges limits = unlimited();
  std::fill(limits.begin(), limits.begin() + kSlices / 2, 1.0);  // the right half is hidden beyond 1 m
  model.apply({{0.0, 0.0, 0.0}, 3.0, true}, limits, grid);
  EXPECT_EQ(grid.evidence[grid.geometry.index(grid.geometry.cell_at({2.05, -0.35}))], 0);
  EXPECT_LT(grid.evidence[grid.geometry.index(grid.geometry.cell_at({2.05, 0.35}))], 0);
}

TEST(FreeSpaceModel, DrawsTheSameWhicheverWayTheRobotLooks) {
  SonarModelParams params;
  FreeSpaceModel model(params);
  OccupancyGrid east({0.1, {-5.05, -5.05}, 101, 101});
  OccupancyGrid north = east;
  // not on a cell's middle, where a border cell may go either way
  model.apply({{0.013, 0.021, 0.0}, 2.5, true}, unlimited(), east);
  model.apply({{-0.021, 0.013, 0.5 * kPi}, 2.5, true}, unlimited(), north);
  for (int row = 0; row < 101; ++row) {
    for (int column = 0; column < 101; ++column) {
      EXPECT_EQ(east.evidence[east.geometry.index({column, row})],
                north.evidence[north.geometry.index({100 - row, column})]);
    }
  }
}

TEST(FreeSpaceModel, DrawsThePapersLineOneCellWide) {
  SonarModelParams params;
  params.kind = SonarModelKind::kLine;
  FreeSpaceModel model(params);
  OccupancyGrid grid(hundred());
  model.apply({{0.05, 0.05, 0.0}, 2.0, true}, unlimited(), grid);
  const auto touched = std::count_if(grid.evidence.begin(), grid.evidence.end(), [](std::int8_t e) { return e != 0; });
  EXPECT_NEAR(static_cast<double>(touched), 18.5, 1.0);  // 2.0 m less the margin of 0.15 m
}

TEST(CellsOfEcho, LieOnTheArcAndWeighMostOnTheAxis) {
  const GridGeometry geometry = hundred();
  const std::vector<ArcCell> cells = cells_of_echo({}, geometry, {{0.0, 0.0, 0.3}, 2.0, true}, 0.0);
  ASSERT_GT(cells.size(), 8U);
  double heaviest = 0.0;
  Cell on_axis;
  for (const ArcCell& cell : cells) {
    EXPECT_NEAR(geometry.centre_of(cell.cell).norm(), 2.025, 0.075);
    if (cell.weight > heaviest) {
      heaviest = cell.weight;
      on_axis = cell.cell;
    }
  }
  EXPECT_EQ(on_axis, geometry.cell_at(2.025 * Eigen::Vector2d(std::cos(0.3), std::sin(0.3))));
}

TEST(CellsOfEcho, AreOneCellOfTheLine) {
  SonarModelParams params;
  params.kind = SonarModelKind::kLine;
  const std::vector<ArcCell> cells = cells_of_echo(params, hundred(), {{0.0, 0.0, 0.3}, 2.0, true}, radians(2.0));
  EXPECT_EQ(cells.size(), 1U);
}

TEST(CellsOfEcho, EndAtTheGridsBorder) {
  const std::vector<ArcCell> cells = cells_of_echo({}, hundred(), {{4.5, 0.0, 0.0}, 2.0, true}, 0.0);
  EXPECT_TRUE(cells.empty());
}

}  // namespace
}  // namespace luminav
