#include "tests/unit/planner/office_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "services/planner/search/cost_field.hpp"
#include "services/planner/space/configuration_space.hpp"

namespace luminav {
namespace {

/// What five planners agree on for this floor: see the performance page.
struct Agreed {
  int side;
  double resolution;
  long occupied;
  std::uint64_t hash;
  long free;           // after expansion by 0.25 m
  long reached;        // 8-connected from the goal
  std::uint32_t cost;  // octile, 5 and 7 a step
  std::size_t path;    // cells, both ends included
};

class OfficeGrid : public ::testing::TestWithParam<Agreed> {
 protected:
  static ConfigurationSpace space_of(const std::vector<std::uint8_t>& cells, const Agreed& agreed) {
    OccupancyGrid grid({agreed.resolution, {0.0, 0.0}, agreed.side, agreed.side});
    std::transform(cells.begin(), cells.end(), grid.prior.begin(),
                   [](std::uint8_t cell) { return cell != 0 ? Prior::kOccupied : Prior::kFree; });
    ConfigurationSpaceParams params;
    params.hard_radius = 0.25;
    params.clearance_weight = 0.0;  // every free cell costs the same
    return {params, grid, {}};
  }
};

TEST_P(OfficeGrid, IsTheOneThatOthersMeasuredOn) {
  const Agreed& agreed = GetParam();
  const std::vector<std::uint8_t> cells = office_grid(agreed.side, agreed.resolution);
  EXPECT_EQ(std::count(cells.begin(), cells.end(), 1), agreed.occupied);
  EXPECT_EQ(fnv1a(cells), agreed.hash);
}

TEST_P(OfficeGrid, IsExpandedReachedAndCrossedAsOthersDo) {
  const Agreed& agreed = GetParam();
  const ConfigurationSpace space = space_of(office_grid(agreed.side, agreed.resolution), agreed);
  EXPECT_EQ(space.passable().count(), agreed.free);
  const int start = static_cast<int>(std::lround(1.0 / agreed.resolution));
  const int goal = agreed.side - 1 - start;
  CostField field;
  grow_cost_field(space.terrain(), {{{goal, goal}, 0}}, {}, field);
  long reached = 0;
  for (std::size_t i = 0; i < field.stored.size(); ++i) {
    reached += field.is_reached(i) ? 1 : 0;
  }
  EXPECT_EQ(reached, agreed.reached);
  const std::size_t start_index = space.geometry().index({start, start});
  EXPECT_EQ(field.cost(start_index), agreed.cost * ConfigurationSpace::kFreePrice);
  EXPECT_EQ(follow_gradient(space.terrain(), field, start_index).size(), agreed.path);
}

INSTANTIATE_TEST_SUITE_P(Floors, OfficeGrid,
                         ::testing::Values(Agreed{200, 0.1, 4884, 0x6516450895bfb1d3ULL, 29273, 29273, 1562, 283},
                                           Agreed{1000, 0.1, 155476, 0xc471d0532145fd35ULL, 646113, 646112, 9274, 1787},
                                           Agreed{4000, 0.1, 2522417, 0xb2e2347e21cfa48eULL, 10265046, 10264399, 37897,
                                                  7328}));

TEST(OfficeGridFine, IsExpandedAsOthersDo) {
  const std::vector<std::uint8_t> cells = office_grid(4000, 0.025);
  EXPECT_EQ(std::count(cells.begin(), cells.end(), 1), 2487660);
  EXPECT_EQ(fnv1a(cells), 0xa9b7f255cff90485ULL);
  BitGrid solid(4000, 4000);
  for (int row = 0; row < 4000; ++row) {
    for (int column = 0; column < 4000; ++column) {
      if (cells[static_cast<std::size_t>(row) * 4000 + static_cast<std::size_t>(column)] != 0) {
        solid.set({column, row});
      }
    }
  }
  const std::vector<std::uint8_t> squares = squared_distances(solid);
  EXPECT_EQ(std::count_if(squares.begin(), squares.end(), [](std::uint8_t square) { return square > 100; }), 9567875);
  BitGrid wide(4000, 4000);
  dilate(solid, 10.0, 0, 4000, wide);
  EXPECT_EQ(4000L * 4000L - wide.count(), 9567875);
}

}  // namespace
}  // namespace luminav
