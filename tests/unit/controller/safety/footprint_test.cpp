#include "services/controller/safety/footprint.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

TEST(Footprint, MeasuresToSidesCornersAndInside) {
  const Footprint footprint(testing::test_robot().footprint);
  EXPECT_NEAR(footprint.distance({0.31, 0.0}), 0.10, 1e-12);
  EXPECT_NEAR(footprint.distance({0.0, -0.3125}), 0.10, 1e-12);
  EXPECT_NEAR(footprint.distance({0.21 + 0.03, 0.2125 + 0.04}), 0.05, 1e-12);
  EXPECT_NEAR(footprint.distance({0.16, 0.0}), -0.05, 1e-12);
  EXPECT_NEAR(footprint.distance({0.21, 0.0}), 0.0, 1e-12);
}

TEST(Footprint, SweepsTheRearCornerWhenTurning) {
  EXPECT_NEAR(Footprint(testing::test_robot().footprint).swept_radius(), std::hypot(0.301, 0.2125), 1e-12);
}

TEST(Footprint, RefusesWhatIsNoConvexPolygon) {
  EXPECT_THROW(Footprint({{0.0, 0.0}, {1.0, 0.0}}), std::invalid_argument);
  EXPECT_THROW(Footprint({{1.0, 1.0}, {1.0, -1.0}, {-1.0, -1.0}, {-1.0, 1.0}}), std::invalid_argument);
}

TEST(DriveArc, IsAStraightLineWithoutTurning) {
  const Pose2 end = drive_arc({0.5, 0.0}, 2.0);
  EXPECT_DOUBLE_EQ(end.x, 1.0);
  EXPECT_DOUBLE_EQ(end.y, 0.0);
  EXPECT_DOUBLE_EQ(end.theta, 0.0);
}

TEST(DriveArc, IsAQuarterCircle) {
  // radius v / w = 1 m, a quarter turn to the left ends at (1, 1)
  const Pose2 end = drive_arc({0.5, 0.5}, kPi);
  EXPECT_NEAR(end.x, 1.0, 1e-12);
  EXPECT_NEAR(end.y, 1.0, 1e-12);
  EXPECT_NEAR(end.theta, kPi / 2.0, 1e-12);
}

TEST(DriveArc, HasNoStepWhereTheSeriesTakesOver) {
  const Pose2 below = drive_arc({1.0, 0.99e-4}, 1.0);
  const Pose2 above = drive_arc({1.0, 1.01e-4}, 1.0);
  EXPECT_NEAR(below.x, above.x, 1e-8);
  EXPECT_NEAR(below.y, above.y, 2e-6);
}

TEST(DriveArc, TwoHalvesAreTheWhole) {
  for (const DriveTwist& twist :
       {DriveTwist{0.3, 0.7}, DriveTwist{-0.2, 0.4}, DriveTwist{0.0, -1.0}, DriveTwist{0.5, 1e-6}}) {
    const Pose2 whole = drive_arc(twist, 1.6);
    const Pose2 halves = drive_arc(twist, 0.8) * drive_arc(twist, 0.8);
    EXPECT_NEAR(whole.x, halves.x, 1e-9);
    EXPECT_NEAR(whole.y, halves.y, 1e-9);
    EXPECT_NEAR(wrap_angle(whole.theta - halves.theta), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace luminav
