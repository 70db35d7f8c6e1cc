#include "services/planner/search/tile_cost_field.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <random>
#include <tuple>

#include "services/planner/search/cost_field.hpp"

namespace luminav {
namespace {

BitGrid random_floor(std::mt19937& rng, int columns, int rows, double density) {
  std::bernoulli_distribution blocked(density);
  BitGrid passable(columns, rows);
  for (int row = 1; row + 1 < rows; ++row) {
    for (int column = 1; column + 1 < columns; ++column) {
      if (!blocked(rng)) {
        passable.set({column, row});
      }
    }
  }
  return passable;
}

/// By hand: steps to four and to eight neighbours in turn.
std::vector<std::uint32_t> ticks_by_hand(const BitGrid& passable, const Cell& goal) {
  const auto at = [&](int column, int row) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(passable.columns()) +
           static_cast<std::size_t>(column);
  };
  std::vector<std::uint32_t> ticks(at(0, passable.rows()), 0);
  std::vector<Cell> front = {goal};
  ticks[at(goal.column, goal.row)] = 1;
  for (std::uint32_t tick = 1; !front.empty(); ++tick) {
    std::vector<Cell> next;
    for (const Cell& cell : front) {
      for (int dr = -1; dr <= 1; ++dr) {
        for (int dc = -1; dc <= 1; ++dc) {
          const bool is_step = tick % 2 == 0 || dr == 0 || dc == 0;
          const Cell to{cell.column + dc, cell.row + dr};
          if (is_step && passable.test(to) && ticks[at(to.column, to.row)] == 0) {
            ticks[at(to.column, to.row)] = tick + 1;
            next.push_back(to);
          }
        }
      }
    }
    front = next;
  }
  return ticks;
}

TEST(TileCostField, StepsToFourAndEightNeighboursInTurn) {
  std::mt19937 rng(5);
  for (const auto& [columns, rows, density] : {std::tuple{40, 30, 0.1}, {8, 8, 0.0}, {65, 23, 0.35}, {130, 71, 0.2}}) {
    BitGrid passable = random_floor(rng, columns, rows, density);
    const Cell goal{columns / 2, rows / 2};
    passable.set(goal);
    TileCostField tiles;
    tiles.grow(passable, std::array{goal});
    const std::vector<std::uint32_t> expected = ticks_by_hand(passable, goal);
    std::int64_t reached = 0;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const std::uint32_t tick = expected[static_cast<std::size_t>(row * columns + column)];
        ASSERT_EQ(tiles.tick({column, row}), tick) << column << " " << row;
        reached += tick != 0 ? 1 : 0;
        EXPECT_TRUE(!passable.test({column, row}) || tiles.is_reached({column, row}) == (tick != 0));
      }
    }
    EXPECT_EQ(tiles.reached(), reached);
  }
}

TEST(TileCostField, DescendsByNeighboursOnPassableCellsAlmostTheShortestWay) {
  std::mt19937 rng(6);
  BitGrid passable = random_floor(rng, 200, 150, 0.05);
  const Cell goal{190, 140};
  const Cell start{7, 9};
  passable.set(goal);
  passable.set(start);
  TileCostField tiles;
  tiles.grow(passable, std::array{goal});
  const std::vector<Cell> cells = tiles.follow_gradient(start);
  ASSERT_GT(cells.size(), 2U);
  EXPECT_EQ(cells.front(), start);
  EXPECT_EQ(cells.back(), goal);
  std::uint32_t length = 0;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    const int across = std::abs(cells[i].column - cells[i - 1].column);
    const int up = std::abs(cells[i].row - cells[i - 1].row);
    ASSERT_TRUE(across <= 1 && up <= 1 && across + up > 0 && passable.test(cells[i]));
    length += across + up == 1 ? 5 : 7;
  }
  const std::array<std::uint8_t, 1> price = {1};
  CostField field;
  grow_cost_field({&passable, nullptr, price.data()}, {{goal, 0}}, {}, field);
  const std::uint32_t shortest = field.cost(static_cast<std::size_t>(start.row) * 200 + 7);
  EXPECT_GE(length, shortest);
  EXPECT_LE(length, shortest * 102 / 100);
}

TEST(TileCostField, ReachesNothingFromABlockedGoalOrIntoAClosedRoom) {
  BitGrid passable(20, 20);
  passable.set({5, 5});
  passable.set({15, 15});
  TileCostField tiles;
  tiles.grow(passable, std::array{Cell{9, 9}});
  EXPECT_EQ(tiles.reached(), 0);
  tiles.grow(passable, std::array{Cell{5, 5}});
  EXPECT_EQ(tiles.reached(), 1);
  EXPECT_TRUE(tiles.is_reached({5, 5}));
  EXPECT_FALSE(tiles.is_reached({15, 15}));
  EXPECT_TRUE(tiles.follow_gradient({15, 15}).empty());
  EXPECT_EQ(tiles.follow_gradient({5, 5}).size(), 1U);
}

}  // namespace
}  // namespace luminav
