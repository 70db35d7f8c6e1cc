#include "services/surveyor/explore/frontier_search.hpp"

#include <gtest/gtest.h>

#include "tests/unit/surveyor/explore/drawn_floor.hpp"

namespace luminav {
namespace {

const Leniency kWall;  // the planner's own

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

/// A corridor round a room of `side` squares of 0.2 m, which has a door of 1.2 m to the left.
OccupancyGrid room_amid_corridors(std::size_t side, char door, char inside) {
  constexpr std::size_t kCorridor = 6;
  const std::size_t width = side + 2 * kCorridor + 4;
  std::vector<std::string> rows(width, std::string(width, '.'));
  for (std::size_t row = 0; row < width; ++row) {
    for (std::size_t column = 0; column < width; ++column) {
      const std::size_t ring = std::min({row, column, width - 1 - row, width - 1 - column});
      rows[row][column] = ring == 0 || ring == kCorridor + 1 ? '#' : ring > kCorridor + 1 ? inside : '.';
    }
  }
  for (std::size_t row = width / 2 - 3; row < width / 2 + 3; ++row) {
    rows[row][kCorridor + 1] = door;
  }
  return drawn_floor(rows);
}

std::vector<Eigen::Vector2d> looks_everywhere() {
  std::vector<Eigen::Vector2d> looks;
  for (double x = 0.0; x < 7.0; x += 0.5) {
    for (double y = 0.0; y < 7.0; y += 0.5) {
      looks.emplace_back(x, y);
    }
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
  const Leniency lenient{.occupied_log_odds = 1.8};
  EXPECT_TRUE(FrontierSearch({}, room('+'), lenient, looks_everywhere(), {}, {2.0, 1.5}).open_floor().best);
}

TEST(FrontierSearch, GoesWhereTheCeilingWasNotSeen) {
  const FrontierSearch search({}, room('#'), kWall, {{1.0, 1.0}, {1.0, 2.0}}, {}, {1.0, 1.5});
  ASSERT_TRUE(search.open_floor().best);
  EXPECT_EQ(search.open_floor().frontiers, 0);
  EXPECT_GT(search.open_floor().best->position.x(), 2.0);
  EXPECT_EQ(search.open_share(search.best_cells()), 1.0);
}

TEST(FrontierSearch, TakesAGapForADoorWhenTold) {
  OccupancyGrid grid = room('#');
  const Cell gap = grid.geometry.cell_at({4.7, 1.5});  // 0.4 m: the robot needs half a metre
  for (int row = gap.row - 1; row <= gap.row + 2; ++row) {
    for (int column = gap.column - 2; column <= gap.column + 2; ++column) {
      grid.evidence[grid.geometry.index({column, row})] = -20;
    }
  }
  EXPECT_FALSE(FrontierSearch({}, grid, kWall, looks_everywhere(), {}, {2.0, 1.5}).open_floor().best);
  const FrontierSearch lenient({}, grid, {.room = 0.6}, looks_everywhere(), {}, {2.0, 1.5});
  ASSERT_TRUE(lenient.open_floor().best);
  EXPECT_GT(lenient.open_floor().best->position.x(), 4.8) << "behind it";
}

TEST(FrontierSearch, TriesAWeakWallOnlyWhereARoomMayLieBehindWhenTold) {
  const Leniency into_rooms{.occupied_log_odds = 1.8, .only_rooms = true};
  const Eigen::Vector2d robot{0.8, 2.0};
  const FrontierSearch room({}, room_amid_corridors(16, '+', ' '), into_rooms, looks_everywhere(), {}, robot);
  ASSERT_TRUE(room.open_floor().best);
  EXPECT_GT(room.open_floor().best->position.x(), 1.6) << "behind the door";
  const OccupancyGrid shaft = room_amid_corridors(10, '+', ' ');
  EXPECT_FALSE(FrontierSearch({}, shaft, into_rooms, looks_everywhere(), {}, robot).open_floor().best);
  const Leniency anywhere{.occupied_log_odds = 1.8};
  EXPECT_TRUE(FrontierSearch({}, shaft, anywhere, looks_everywhere(), {}, robot).open_floor().best);
}

TEST(FrontierSearch, KeepsARoomOpenWhoseDoorWasDrawnShutBeforeItWasSeen) {
  const auto search = [](char door, char inside) {
    return FrontierSearch({}, room_amid_corridors(16, door, inside), kWall, looks_everywhere(), {}, {0.8, 2.0});
  };
  const std::vector<Eigen::Vector2d> hoped = search('.', ' ').best_cells();
  ASSERT_FALSE(hoped.empty());
  EXPECT_FALSE(search('#', ' ').open_floor().best);
  EXPECT_GT(search('#', ' ').open_share(hoped), 0.5);
  EXPECT_EQ(search('.', '.').open_share(hoped), 0.0);
}

TEST(FrontierSearch, HopesForLessEachTimeAndLeavesAloneWhatWasTriedOften) {
  TriedFloor tried;
  double before = 1e9;  // [m^2]
  for (int i = 0; i < FrontierParams{}.max_tries; ++i) {
    const FrontierSearch search({}, room('.'), {.min_gain = 0.01}, looks_everywhere(), tried, {2.0, 1.5});
    ASSERT_TRUE(search.open_floor().best);
    EXPECT_LT(search.open_floor().best->gain, before);
    before = search.open_floor().best->gain;
    const FrontierSearch all({}, room('.'), kWall, looks_everywhere(), {}, {2.0, 1.5});
    tried.add(all.best_cells());
    tried.add({{100.0, 100.0}});  // elsewhere
  }
  EXPECT_FALSE(FrontierSearch({}, room('.'), kWall, looks_everywhere(), tried, {2.0, 1.5}).open_floor().best);
}

TEST(FrontierSearch, FindsNothingForARobotWithoutRoom) {
  EXPECT_FALSE(FrontierSearch({}, room('.'), kWall, {}, {}, {5.8, 0.1}).open_floor().best);
}

}  // namespace
}  // namespace luminav
