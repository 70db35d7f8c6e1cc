#include "services/common/building/distance_transform.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace luminav {
namespace {

TEST(DistanceTransform, IsTheSquaredDistanceToTheNearestSolidCell) {
  constexpr std::size_t kColumns = 31;
  constexpr std::size_t kRows = 17;
  std::mt19937 rng(42);
  for (const int one_in : {2, 20, 300}) {
    std::vector<bool> is_solid(kColumns * kRows, false);
    is_solid[std::uniform_int_distribution<std::size_t>(0, is_solid.size() - 1)(rng)] = true;
    for (std::size_t i = 0; i < is_solid.size(); ++i) {
      is_solid[i] = is_solid[i] || rng() % static_cast<unsigned>(one_in) == 0;
    }
    const std::vector<float> squared = squared_distances_to(is_solid, kColumns);
    for (std::size_t i = 0; i < is_solid.size(); ++i) {
      double expected = 1e9;
      for (std::size_t k = 0; k < is_solid.size(); ++k) {
        const double dx = static_cast<double>(i % kColumns) - static_cast<double>(k % kColumns);
        const double dy = static_cast<double>(i / kColumns) - static_cast<double>(k / kColumns);
        expected = is_solid[k] ? std::min(expected, dx * dx + dy * dy) : expected;
      }
      ASSERT_EQ(squared[i], expected) << i << " of one in " << one_in;
    }
  }
}

TEST(DistanceTransform, IsFarWhereNothingIsSolid) {
  const std::vector<float> squared = squared_distances_to(std::vector<bool>(6, false), 3);
  EXPECT_GE(*std::min_element(squared.begin(), squared.end()), kNoSolidCell);
  EXPECT_TRUE(squared_distances_to({}, 0).empty());
}

}  // namespace
}  // namespace luminav
