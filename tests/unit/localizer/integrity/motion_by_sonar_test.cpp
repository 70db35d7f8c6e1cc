#include "services/localizer/integrity/motion_by_sonar.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr double kHalfAngle = radians(15.0);

/// A room of 8 x 5 m with a pillar.
PriorMap room() {
  PriorMap map;
  map.geometry = {0.1, {0.0, 0.0}, 80, 50};
  for (int row = 0; row < 50; ++row) {
    for (int column = 0; column < 80; ++column) {
      const bool is_wall = row == 0 || column == 0 || row == 49 || column == 79;
      const bool is_pillar = row >= 35 && row < 40 && column >= 30 && column < 36;
      map.cells.push_back(is_wall || is_pillar ? Prior::kOccupied : Prior::kFree);
    }
  }
  return map;
}

/// A robot that drives 0.3 m or turns 30 degrees at a time, as its wheels tell, and hears the room from where it is.
class MotionBySonarTest : public ::testing::Test {
 protected:
  /// `grip`: share of the step that it makes; `boxed`: discs that hear a box before the wall.
  [[nodiscard]] PoseBelief belief() const { return {Pose2{1.5, 2.0, 0.0} * odom_, 1e-4 * Eigen::Matrix3d::Identity()}; }
  [[nodiscard]] double ratio_of(const Pose2& moved) const { return motion_.log_ratio(moved, belief(), odom_); }
  void drive(const Pose2& step, double grip = 1.0, int boxed = 0) {
    odom_ = odom_ * step;
    true_ = true_ * Pose2{grip * step.x, grip * step.y, grip * step.theta};
    std::vector<PlacedEcho> echoes;
    for (int disc = 0; disc < 16; ++disc) {
      const double angle = true_.theta + disc * radians(22.5);
      const double wall = walls_.range_to_wall(true_.position(), {std::cos(angle), std::sin(angle)}, 3.0);
      const double range = disc < boxed ? 0.6 * wall : wall;
      if (range < 2.9) {
        const double own = disc * radians(22.5);
        echoes.push_back({{0.0, 0.0}, {range * std::cos(own), range * std::sin(own)}, range, 0.5, 0.0});
      }
    }
    motion_.listen(echoes, odom_, belief());
  }

  WallField walls_{room()};
  MotionBySonar motion_{walls_, kHalfAngle};
  Pose2 odom_;
  Pose2 true_{1.5, 2.0, 0.0};
};

TEST_F(MotionBySonarTest, IsNoneWhileTheRobotMovesAsItsWheelsTell) {
  for (int i = 0; i < 6; ++i) {
    drive({0.3, 0.0, 0.0});
    EXPECT_FALSE(motion_.take());
    drive({0.0, 0.0, radians(30.0)});
    EXPECT_FALSE(motion_.take());
  }
}

TEST_F(MotionBySonarTest, IsHeardWhereTheRobotDrivesLessThanItsWheelsTell) {
  drive({0.3, 0.0, 0.0});
  std::optional<Pose2> moved;
  for (int i = 0; i < 8 && !moved; ++i) {
    drive({0.3, 0.0, 0.0}, 0.5);
    moved = motion_.take();
  }
  ASSERT_TRUE(moved);
  EXPECT_LT(distance(*moved, true_), 0.25);
  EXPECT_FALSE(motion_.take()) << "once";
}

TEST_F(MotionBySonarTest, IsHeardWhereItTurnsLess) {
  drive({0.3, 0.0, 0.0});
  std::optional<Pose2> moved;
  for (int i = 0; i < 8 && !moved; ++i) {
    drive({0.1, 0.0, radians(25.0)}, 0.5);
    moved = motion_.take();
  }
  ASSERT_TRUE(moved);
  EXPECT_LT(std::abs(wrap_angle(moved->theta - true_.theta)), radians(15.0));
}

TEST_F(MotionBySonarTest, IsHeardAfterABumpTurnedIt) {
  drive({0.3, 0.0, 0.0});
  true_ = true_ * Pose2{0.0, 0.0, radians(12.0)};
  std::optional<Pose2> turned;
  for (int i = 0; i < 8 && !turned; ++i) {
    drive({0.3, 0.0, 0.0});
    turned = motion_.take();
  }
  ASSERT_TRUE(turned);
  EXPECT_LT(std::abs(wrap_angle(turned->theta - true_.theta)), radians(4.0));
  EXPECT_LT(distance(*turned, true_), 0.25);
}

TEST_F(MotionBySonarTest, SpeaksForWhereARobotIsThatSlippedAtSomeTime) {
  drive({0.3, 0.0, 0.0});
  for (int i = 0; i < 5; ++i) {
    drive({0.3, 0.0, 0.0}, 0.5);
  }
  EXPECT_GT(ratio_of(true_), 0.5);
  EXPECT_LT(ratio_of(belief().pose * Pose2{0.4, 0.3, 0.0}), ratio_of(true_));
}

TEST_F(MotionBySonarTest, SpeaksAgainstAPoseAsideOfARobotThatDidNotSlip) {
  for (int i = 0; i < 4; ++i) {
    drive({0.3, 0.0, 0.0});
  }
  EXPECT_LT(ratio_of(belief().pose * Pose2{0.28, 0.28, 0.0}), -0.9);
  motion_.clear();
  EXPECT_EQ(ratio_of(belief().pose * Pose2{0.28, 0.28, 0.0}), 0.0) << "nothing heard since the last fixture";
}

TEST_F(MotionBySonarTest, BoxesThatNoMapHasAreNone) {
  for (int i = 0; i < 8; ++i) {
    drive({0.3, 0.0, radians(5.0)}, 1.0, 5);
    EXPECT_FALSE(motion_.take());
  }
}

TEST_F(MotionBySonarTest, WhatWasHeardBeforeAFixtureWasSeenCountsNoMore) {
  for (int i = 0; i < 8; ++i) {
    drive({0.3, 0.0, 0.0}, 0.5);
    motion_.clear();
  }
  EXPECT_FALSE(motion_.take());
}

TEST(MotionBySonar, WithoutAMapNothingIsHeard) {
  const WallField nothing;
  MotionBySonar motion(nothing, kHalfAngle);
  const std::vector<PlacedEcho> echoes(8, PlacedEcho{{0.0, 0.0}, {1.0, 0.0}, 1.0, 1.0, 0.0});
  for (int i = 0; i < 8; ++i) {
    motion.listen(echoes, {0.3 * i, 0.0, 0.0}, {});
  }
  EXPECT_FALSE(motion.take());
}

}  // namespace
}  // namespace luminav
