#include "services/planner/goals/path_progress.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

// there and back again, 0.1 m beside
const Polyline kLoop = {{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}, {2.0, 0.1}, {1.0, 0.1}, {0.0, 0.1}};

TEST(PathProgress, LooksForTheNearestPointForwardsOnly) {
  EXPECT_EQ(nearest_ahead(kLoop, 0, {1.1, 0.0}), 1U);
  EXPECT_EQ(nearest_ahead(kLoop, 2, {1.1, 0.0}), 4U);
}

TEST(PathProgress, DoesNotCutAPathShortThatComesBack) {
  Polyline path;
  for (int i = 0; i <= 8; ++i) {
    path.emplace_back(0.5 * i, 0.0);
  }
  path.emplace_back(0.05, 0.0);  // near the start again, 4 m ahead
  EXPECT_EQ(nearest_ahead(path, 0, {0.05, 0.0}), 0U);
}

TEST(PathProgress, KeepsTheLastPointAtTheEnd) {
  EXPECT_EQ(rest_of(kLoop, 4, {1.0, 0.2}), (Polyline{{1.0, 0.2}, {0.0, 0.1}}));
  EXPECT_EQ(rest_of(kLoop, 5, {0.0, 0.2}), (Polyline{{0.0, 0.2}, {0.0, 0.1}}));
}

}  // namespace
}  // namespace luminav
