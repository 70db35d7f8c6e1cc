#include "services/surveyor/explore/frontier_search.hpp"

#include <gtest/gtest.h>

#include "tests/unit/surveyor/explore/drawn_floor.hpp"

namespace luminav {
namespace {

constexpr double kWall = 0.8;  // evidence of the mapper's walls

/// A room of 4 x 2 m, closed but for a door in its right wall.
OccupancyGrid room(char door) {
  std::vector<std::string> rows(12, "                              ");
  for (std::size_t row = 0; row < 12; ++row) {
    for (std::size_t column = 2; column < 24; ++column) {
      const bool is_wall = row == 0 || row == 11 || column == 2 || column == 23;
      rows[row][column] = is_wall ? '#' : '.';
    }
  }
  for (std::size_t row = 3; row < 9; ++row) {
    rows[row][23] = door;
  }
  rows.insert(rows.begin(), 2, rows.front());
  rows.insert(rows.end(), 2, rows.back());
  rows.front() = rows.back() = std::string(30, ' ');
  return drawn_floor(rows);
}

std::vector<Eigen::Vector2d> looks_everywhere() {
  std::vector<Eigen::Vector2d> looks;
  for (double x = 0.0; x < 6.0; x += 0.5) {
    looks.insert(looks.end(), {{x, 1.0}, {x, 2.0}});
  }
  return looks;
}

TEST(FrontierSearch, FindsNothingInAClosedRoomThatWasSeen) {
  const FrontierSearch search({}, room('#'), kWall, looks_everywhere(), {}, {2.0, 1.5});
  EXPECT_FALSE(search.open_floor().best);
  EXPECT_EQ(search.open_floor().frontiers, 0);
  EXPECT_NEAR(search.open_floor().unseen, 0.0, 1e-9);
  EXPECT_GT(search.open_floor().reachable, 4.0);
}

TEST(FrontierSearch, GoesToADoorBehindWhichNothingIsKnown) {
  const FrontierSearch search({}, room('.'), kWall, looks_everywhere(), {}, {2.0, 1.5});
  ASSERT_TRUE(search.open_floor().best);
  EXPECT_EQ(search.open_floor().frontiers, 1);
  EXPECT_NEAR(search.open_floor().best->position.x(), 4.5, 0.9);
}

TEST(FrontierSearch, TakesAWeakWallForADoorWhenTold) {
  EXPECT_FALSE(FrontierSearch({}, room('+'), kWall, looks_everywhere(), {}, {2.0, 1.5}).open_floor().best);
  EXPECT_TRUE(FrontierSearch({}, room('+'), 1.8, looks_everywhere(), {}, {2.0, 1.5}).open_floor().best);
}

TEST(FrontierSearch, GoesWhereTheCeilingWasNotSeen) {
  const FrontierSearch search({}, room('#'), kWall, {{1.0, 1.0}, {1.0, 2.0}}, {}, {1.0, 1.5});
  ASSERT_TRUE(search.open_floor().best);
  EXPECT_EQ(search.open_floor().frontiers, 0);
  EXPECT_GT(search.open_floor().best->position.x(), 2.0);
  const std::vector<Eigen::Vector2d> cells = search.open_cells(search.open_floor().best->position);
  EXPECT_NEAR(search.gain_of(cells), search.open_floor().best->gain, 1e-9);
  EXPECT_EQ(search.still_open(cells).size(), cells.size());
}

TEST(FrontierSearch, LeavesAloneWhatWasGivenUp) {
  const FrontierSearch before({}, room('.'), kWall, looks_everywhere(), {}, {2.0, 1.5});
  ASSERT_TRUE(before.open_floor().best);
  const std::vector<Eigen::Vector2d> cells = before.open_cells(before.open_floor().best->position);
  ASSERT_FALSE(cells.empty());
  EXPECT_FALSE(FrontierSearch({}, room('.'), kWall, looks_everywhere(), cells, {2.0, 1.5}).open_floor().best);
}

TEST(FrontierSearch, FindsNothingForARobotWithoutRoom) {
  EXPECT_FALSE(FrontierSearch({}, room('.'), kWall, {}, {}, {5.8, 0.1}).open_floor().best);
}

}  // namespace
}  // namespace luminav
