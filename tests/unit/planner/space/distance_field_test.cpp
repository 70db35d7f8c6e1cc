#include "services/planner/space/distance_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>

namespace luminav {
namespace {

std::vector<std::uint8_t> random_cells(int columns, int rows, double density, unsigned seed) {
  std::mt19937 rng(seed);
  std::bernoulli_distribution set(density);
  std::vector<std::uint8_t> cells(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  std::generate(cells.begin(), cells.end(), [&] { return set(rng) ? 1 : 0; });
  return cells;
}

BitGrid bits_of(const std::vector<std::uint8_t>& cells, int columns) {
  BitGrid bits(columns, static_cast<int>(cells.size()) / columns);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] != 0) {
      bits.set({static_cast<int>(i) % columns, static_cast<int>(i) / columns});
    }
  }
  return bits;
}

int by_hand(const std::vector<std::uint8_t>& cells, int columns, int rows, int column, int row) {
  int best = kNothingNear;
  for (int r = std::max(0, row - kDistanceReach); r <= std::min(rows - 1, row + kDistanceReach); ++r) {
    for (int c = std::max(0, column - kDistanceReach); c <= std::min(columns - 1, column + kDistanceReach); ++c) {
      if (cells[static_cast<std::size_t>(r * columns + c)] != 0) {
        best = std::min(best, (r - row) * (r - row) + (c - column) * (c - column));
      }
    }
  }
  return best;
}

TEST(SquaredDistances, AreExactWithinReach) {
  for (const auto& [columns, rows, density] :
       {std::tuple{40, 30, 0.01}, {33, 47, 0.1}, {50, 50, 0.001}, {3, 60, 0.05}}) {
    const auto cells = random_cells(columns, rows, density, 11);
    const std::vector<std::uint8_t> result = squared_distances(bits_of(cells, columns));
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        EXPECT_EQ(result[static_cast<std::size_t>(row * columns + column)], by_hand(cells, columns, rows, column, row));
      }
    }
  }
}

TEST(SquaredDistances, AreFarEverywhereInAnEmptyGrid) {
  const std::vector<std::uint8_t> result = squared_distances(BitGrid(10, 10));
  EXPECT_EQ(std::count(result.begin(), result.end(), kNothingNear), 100);
}

TEST(SquaredDistances, OfAWindowAreThoseOfTheWhole) {
  auto cells = random_cells(120, 90, 0.01, 5);
  std::vector<std::uint8_t> updated = squared_distances(bits_of(cells, 120));
  cells[50 * 120 + 60] = 1;
  cells[52 * 120 + 61] = 0;
  const std::vector<std::uint8_t> whole = squared_distances(bits_of(cells, 120));
  const CellWindow window = CellWindow{60, 62, 50, 53}.grown(kDistanceReach, 120, 90);
  update_squared_distances(bits_of(cells, 120), window, updated.data());
  EXPECT_EQ(updated, whole);
}

TEST(Dilate, SetsTheExactDisc) {
  for (const auto& [columns, rows, density, radius] : {std::tuple{70, 40, 0.01, 2.5},
                                                       {129, 33, 0.003, 3.0},
                                                       {64, 50, 0.002, 10.0},
                                                       {5, 60, 0.05, 3.9},
                                                       {2000, 90, 0.0005, 4.5},
                                                       {40, 40, 0.01, 0.0}}) {
    const auto cells = random_cells(columns, rows, density, 21);
    BitGrid wide(columns, rows);
    dilate(bits_of(cells, columns), radius, 0, rows, wide);
    BitGrid expected(columns, rows);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        if (by_hand(cells, columns, rows, column, row) <= radius * radius) {
          expected.set({column, row});
        }
      }
    }
    EXPECT_EQ(wide, expected) << columns << " columns, radius " << radius;
  }
}

TEST(Dilate, WritesOnlyTheRowsAskedFor) {
  const auto cells = random_cells(100, 60, 0.01, 22);
  BitGrid whole(100, 60);
  dilate(bits_of(cells, 100), 3.0, 0, 60, whole);
  BitGrid part(100, 60);
  dilate(bits_of(cells, 100), 3.0, 20, 30, part);
  for (int row = 0; row < 60; ++row) {
    for (int column = 0; column < 100; ++column) {
      EXPECT_EQ(part.test({column, row}), row >= 20 && row < 30 && whole.test({column, row}));
    }
  }
}

TEST(Difference, IsTheSmallestWindowWithAllChanges) {
  BitGrid a(200, 50);
  BitGrid b(200, 50);
  EXPECT_TRUE(difference(a, b).is_empty());
  a.set({63, 10});
  b.set({130, 12});
  const CellWindow window = difference(a, b);
  EXPECT_EQ(window.first_column, 63);
  EXPECT_EQ(window.last_column, 131);
  EXPECT_EQ(window.first_row, 10);
  EXPECT_EQ(window.last_row, 13);
}

}  // namespace
}  // namespace luminav
