#include "services/controller/safety/free_heading.hpp"

#include <gtest/gtest.h>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

using testing::around;
using testing::obstacle_at;

TEST(FreeDistance, EndsBeforeWhatStandsInTheStrip) {
  const std::vector<ObstaclePoint> post = around({obstacle_at(1.0, 0.1)}).points();
  EXPECT_NEAR(free_distance(0.0, 3.0, post, {}), 1.0 - 0.21, 1e-12);
  EXPECT_DOUBLE_EQ(free_distance(0.0, 0.5, post, {}), 0.5);
  EXPECT_DOUBLE_EQ(free_distance(kPi, 3.0, post, {}), 3.0);
  const std::vector<ObstaclePoint> beside = around({obstacle_at(1.0, 0.3)}).points();
  EXPECT_DOUBLE_EQ(free_distance(0.0, 3.0, beside, {}), 3.0);
}

TEST(FreeHeading, IsTheWishWhereItIsFree) {
  EXPECT_DOUBLE_EQ(choose_free_heading(0.3, 1.0, std::nullopt, {}, {}), 0.3);
}

TEST(FreeHeading, GoesRoundABoxOnTheShorterSide) {
  // reaches farther to the left than to the right
  const std::vector<ObstaclePoint> box = around(testing::wall({0.9, -0.05}, {0.9, 0.4})).points();
  const double heading = choose_free_heading(0.0, 1.0, std::nullopt, box, {});
  EXPECT_LT(heading, -0.15);
  EXPECT_GT(free_distance(heading, 1.0, box, {}), 0.9);
}

TEST(FreeHeading, KeepsToTheSideItChose) {
  const std::vector<ObstaclePoint> box = around(testing::wall({0.9, -0.2}, {0.9, 0.2})).points();
  EXPECT_GT(choose_free_heading(0.02, 1.0, 0.5, box, {}), 0.0);
  EXPECT_GT(choose_free_heading(-0.02, 1.0, 0.5, box, {}), 0.0);
  EXPECT_LT(choose_free_heading(0.02, 1.0, -0.5, box, {}), 0.0);
}

}  // namespace
}  // namespace luminav
