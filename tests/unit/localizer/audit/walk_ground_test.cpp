#include "services/localizer/audit/walk_ground.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

/// A square of four places a metre apart, 0 1 / 2 3, without the diagonals.
WalkGround square() {
  return {{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}}, {{1, 2}, {0, 3}, {0, 3}, {1, 2}}};
}

TEST(GroundSearch, GivesPlacesByTheirDistanceAndThePathsThere) {
  const WalkGround ground = square();
  GroundSearch search(ground);
  for (int again = 0; again < 2; ++again) {
    search.begin({0});
    std::vector<std::int32_t> order;
    while (const auto place = search.next()) {
      order.push_back(*place);
      search.pass(*place);
    }
    EXPECT_EQ(order.size(), 4U);
    EXPECT_EQ(order.back(), 3);
    EXPECT_DOUBLE_EQ(search.distance(3), 2.0);
    std::vector<std::int32_t> path{0};
    search.append_path(3, path);
    EXPECT_EQ(path, (std::vector<std::int32_t>{0, 1, 3}));
  }
}

TEST(GroundSearch, LeadsNowhereThroughPlacesThatWereNotPassed) {
  const WalkGround ground = square();
  GroundSearch search(ground);
  search.begin({0});
  while (const auto place = search.next()) {
    if (*place == 0) {
      search.pass(0);
    }
  }
  EXPECT_EQ(search.touched().size(), 3U);
}

TEST(GroundSearch, BeginsAtSeveralPlaces) {
  const WalkGround ground = square();
  GroundSearch search(ground);
  search.begin({1, 2});
  while (const auto place = search.next()) {
    search.pass(*place);
  }
  EXPECT_DOUBLE_EQ(search.distance(3), 1.0);
  EXPECT_DOUBLE_EQ(search.distance(2), 0.0);
}

}  // namespace
}  // namespace luminav
