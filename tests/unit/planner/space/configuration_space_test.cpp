#include "services/planner/space/configuration_space.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/unit/planner/floor_plan.hpp"

namespace luminav {
namespace {

TEST(ConfigurationSpace, BlocksWithinTheRadiusOfAnOccupiedCell) {
  OccupancyGrid grid = empty_room(4.0, 4.0);
  grid.prior[grid.geometry.index({20, 20})] = Prior::kOccupied;
  const ConfigurationSpace space({}, grid, {});
  EXPECT_TRUE(space.is_blocked({23, 20}));   // 0.30 m
  EXPECT_FALSE(space.is_blocked({24, 20}));  // 0.40 m
  EXPECT_TRUE(space.is_blocked({22, 22}));   // 0.28 m
  EXPECT_FALSE(space.is_blocked({22, 23}));  // 0.36 m
  EXPECT_TRUE(space.is_solid({20, 20}));
  EXPECT_FALSE(space.is_solid({21, 20}));
}

TEST(ConfigurationSpace, TakesAResolutionThatWentThroughAFloat) {
  OccupancyGrid grid({0.1F, {0.0, 0.0}, 40, 40});
  std::fill(grid.prior.begin(), grid.prior.end(), Prior::kFree);
  grid.prior[grid.geometry.index({20, 20})] = Prior::kOccupied;
  ConfigurationSpaceParams params;
  params.hard_radius = 0.30;  // a hair less than three cells
  const ConfigurationSpace space(params, grid, {});
  EXPECT_TRUE(space.is_blocked({23, 20}));
  EXPECT_TRUE(space.is_blocked({20, 17}));
  EXPECT_FALSE(space.is_blocked({24, 20}));
}

TEST(ConfigurationSpace, CostsLessTheFartherFromWalls) {
  const ConfigurationSpace space({}, empty_room(6.0, 6.0), {});
  int last = std::numeric_limits<int>::max();
  for (int column = 5; column < 20; ++column) {
    const int price = space.price({column, 32});
    EXPECT_LE(price, last);
    EXPECT_GE(price, ConfigurationSpace::kFreePrice);
    last = price;
  }
  EXPECT_EQ(last, ConfigurationSpace::kFreePrice);
}

TEST(ConfigurationSpace, LetsADoorOfNinetyCentimetresPass) {
  OccupancyGrid grid = empty_room(6.0, 4.0);
  build_wall(grid, 3.0, 0.0, 3.2, 4.4);
  build_wall(grid, 3.0, 1.8, 3.2, 2.7, Prior::kFree);
  const ConfigurationSpace space({}, grid, {});
  EXPECT_FALSE(space.is_blocked(space.geometry().cell_at({3.05, 2.25})));
  EXPECT_FALSE(space.is_blocked(space.geometry().cell_at({3.15, 2.25})));
}

TEST(ConfigurationSpace, BlocksWhatIsUnknownUnlessToldOtherwise) {
  OccupancyGrid grid = empty_room(4.0, 4.0);
  build_wall(grid, 1.0, 1.0, 2.0, 2.0, Prior::kUnknown);
  const Cell cell = grid.geometry.cell_at({1.5, 1.5});
  EXPECT_TRUE(ConfigurationSpace({}, grid, {}).is_blocked(cell));
  EXPECT_FALSE(ConfigurationSpace({.unknown_is_free = true}, grid, {}).is_blocked(cell));
  grid.evidence[grid.geometry.index(cell)] = -20;
  EXPECT_FALSE(ConfigurationSpace({}, grid, {}).is_blocked(cell)) << "the sonars saw it free";
}

TEST(ConfigurationSpace, BlocksDisputedWallsUnlessToldOtherwise) {
  OccupancyGrid grid = empty_room(4.0, 4.0);
  const Cell cell{20, 20};
  grid.prior[grid.geometry.index(cell)] = Prior::kDisputed;
  EXPECT_TRUE(ConfigurationSpace({}, grid, {}).is_blocked(cell));
  EXPECT_FALSE(ConfigurationSpace({.disputed_is_free = true}, grid, {}).is_blocked(cell));
}

TEST(ConfigurationSpace, TakesEvidenceAboveTheThresholdForAnObstacle) {
  OccupancyGrid grid = empty_room(4.0, 4.0);
  const Cell cell{20, 20};
  grid.evidence[grid.geometry.index(cell)] = 16;
  EXPECT_FALSE(ConfigurationSpace({}, grid, {}).is_solid(cell));
  grid.evidence[grid.geometry.index(cell)] = 17;
  EXPECT_TRUE(ConfigurationSpace({}, grid, {}).is_solid(cell));
  EXPECT_FALSE(ConfigurationSpace({}, grid, {}, false).is_solid(cell)) << "by the building's map alone";
}

TEST(ConfigurationSpace, TreatsASuspectedObstacleAsOne) {
  const OccupancyGrid grid = empty_room(4.0, 4.0);
  const ConfigurationSpace space({}, grid, {{{2.0, 2.0}, 0.15}});
  EXPECT_TRUE(space.is_solid(grid.geometry.cell_at({2.05, 2.05})));
  EXPECT_TRUE(space.is_blocked(grid.geometry.cell_at({2.3, 2.05})));
}

TEST(ConfigurationSpace, BlocksTheBorderOfTheGrid) {
  OccupancyGrid grid({0.1, {0.0, 0.0}, 20, 20});
  std::fill(grid.prior.begin(), grid.prior.end(), Prior::kFree);
  const ConfigurationSpace space({}, grid, {});
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(space.is_blocked({i, 0}) && space.is_blocked({i, 19}) && space.is_blocked({0, i}) &&
                space.is_blocked({19, i}));
  }
  EXPECT_TRUE(space.is_blocked({-1, 5}));
  EXPECT_FALSE(space.is_blocked({1, 1}));
}

TEST(ConfigurationSpace, RefusesImpossibleParameters) {
  const OccupancyGrid grid = empty_room(2.0, 2.0);
  EXPECT_THROW(ConfigurationSpace({.hard_radius = -0.1}, grid, {}), std::invalid_argument);
  EXPECT_THROW(ConfigurationSpace({.hard_radius = 0.5, .clearance_range = 0.4}, grid, {}), std::invalid_argument);
}

/// Prices of all cells.
std::vector<int> prices_of(const ConfigurationSpace& space) {
  std::vector<int> prices;
  for (int row = 0; row < space.geometry().rows; ++row) {
    for (int column = 0; column < space.geometry().columns; ++column) {
      prices.push_back(space.price({column, row}));
    }
  }
  return prices;
}

TEST(ConfigurationSpace, IsTheSameUpdatedOrMadeAnewAndSaysWhatChanged) {
  std::mt19937 rng(3);
  for (const double weight : {0.3, 0.0}) {
    OccupancyGrid grid = empty_room(14.0, 9.0);
    ConfigurationSpaceParams params;
    params.clearance_weight = weight;
    params.zones = {{"stairs", ZoneKind::kKeepOut, {{3.0, 3.0}, {6.0, 3.5}, {4.0, 6.0}}}};
    ConfigurationSpace space(params, grid, {});
    std::uniform_int_distribution<int> column(0, grid.geometry.columns - 1);
    std::uniform_int_distribution<int> row(0, grid.geometry.rows - 1);
    for (int round = 0; round < 30; ++round) {
      const std::vector<int> before = prices_of(space);
      for (int i = 0; i < 3; ++i) {
        const std::size_t cell = grid.geometry.index({column(rng), row(rng)});
        grid.prior[cell] = static_cast<Prior>(rng() % 4);
        grid.evidence[cell] = static_cast<std::int8_t>(static_cast<int>(rng() % 101) - 50);
      }
      const ConfigurationSpace::Update update = space.update(grid, {});
      const std::vector<int> after = prices_of(space);
      ASSERT_TRUE(update.is_local);
      ASSERT_EQ(after, prices_of(ConfigurationSpace(params, grid, {})));
      std::vector<int> undone = after;
      for (const PriceChange& change : update.changes) {
        EXPECT_NE(undone[change.cell], change.price_before);
        undone[change.cell] = change.price_before;
      }
      ASSERT_EQ(undone, before);
      EXPECT_DOUBLE_EQ(space.clearance({70, 40}), ConfigurationSpace(params, grid, {}).clearance({70, 40}));
    }
  }
}

}  // namespace
}  // namespace luminav
