#include "services/planner/distance_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace luminav {
namespace {

std::vector<std::uint8_t> random_cells(int columns, int rows, double density, unsigned seed) {
  std::mt19937 rng(seed);
  std::bernoulli_distribution set(density);
  std::vector<std::uint8_t> cells(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  std::generate(cells.begin(), cells.end(), [&] { return set(rng) ? 1 : 0; });
  return cells;
}

int by_hand(const std::vector<std::uint8_t>& cells, int columns, int rows, int column, int row) {
  int best = kNothingNear;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const int square = (r - row) * (r - row) + (c - column) * (c - column);
      const bool in_reach = std::abs(r - row) <= kDistanceReach && std::abs(c - column) <= kDistanceReach;
      if (cells[static_cast<std::size_t>(r * columns + c)] != 0 && in_reach) {
        best = std::min(best, square);
      }
    }
  }
  return best;
}

TEST(SquaredDistances, AreExactWithinReach) {
  for (const auto& [columns, rows, density] :
       {std::tuple{40, 30, 0.01}, {33, 47, 0.1}, {50, 50, 0.001}, {3, 60, 0.05}}) {
    const auto cells = random_cells(columns, rows, density, 11);
    std::vector<std::uint8_t> result;
    squared_distances(cells, columns, rows, result);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        EXPECT_EQ(result[static_cast<std::size_t>(row * columns + column)], by_hand(cells, columns, rows, column, row));
      }
    }
  }
}

TEST(SquaredDistances, AreFarEverywhereInAnEmptyGrid) {
  std::vector<std::uint8_t> result;
  squared_distances(std::vector<std::uint8_t>(100, 0), 10, 10, result);
  EXPECT_EQ(std::count(result.begin(), result.end(), kNothingNear), 100);
}

TEST(SquaredDistances, OfAWindowAreThoseOfTheWhole) {
  auto cells = random_cells(120, 90, 0.01, 5);
  std::vector<std::uint8_t> updated;
  squared_distances(cells, 120, 90, updated);
  cells[50 * 120 + 60] = 1;
  cells[52 * 120 + 61] = 0;
  std::vector<std::uint8_t> whole;
  squared_distances(cells, 120, 90, whole);
  update_squared_distances(cells, 120, 90, 60 - kDistanceReach, 62 + kDistanceReach, 50 - kDistanceReach,
                           53 + kDistanceReach, updated);
  EXPECT_EQ(updated, whole);
}

}  // namespace
}  // namespace luminav
