#include "services/surveyor/explore/tried_floor.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(TriedFloor, CountsGoalsAndNotTheirPoints) {
  TriedFloor tried;
  tried.add({{1.05, 2.05}, {1.15, 2.05}});
  EXPECT_EQ(tried.tries({1.05, 2.05}), 1);
  tried.add({{1.05, 2.05}});
  EXPECT_EQ(tried.tries({1.05, 2.05}), 2);
}

TEST(TriedFloor, CountsWhatLiesCloseByAsTheSame) {
  TriedFloor tried;
  tried.add({{-0.05, -0.05}});
  EXPECT_EQ(tried.tries({-0.25, 0.15}), 1);
  EXPECT_EQ(tried.tries({-0.35, -0.05}), 0);
  EXPECT_EQ(tried.tries({0.25, -0.05}), 0);
}

}  // namespace
}  // namespace luminav
