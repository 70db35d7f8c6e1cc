#include "services/controller/safety/sonar_firing.hpp"

#include <gtest/gtest.h>

#include "services/common/geometry/angle.hpp"
#include "tests/unit/controller/test_robot.hpp"

namespace luminav {
namespace {

const SonarRing kRing = testing::test_robot().sonar;

SonarFiring firing(std::size_t disc, double range, bool has_echo = true) {
  SonarFiring made;
  made.disc = disc;
  made.range = range;
  made.has_echo = has_echo;
  return made;
}

TEST(SonarFiring, HearsTheSameWithinTheNoiseOfAnEcho) {
  EXPECT_TRUE(hear_the_same(firing(3, 1.000), firing(3, 1.004)));
  EXPECT_FALSE(hear_the_same(firing(3, 1.000), firing(3, 0.994)));
}

TEST(SonarFiring, SilenceIsNotTheSameAsSilence) {
  EXPECT_FALSE(hear_the_same(firing(3, 3.0, false), firing(3, 3.0, false)));
  EXPECT_FALSE(hear_the_same(firing(3, 3.0), firing(3, 3.0, false)));
}

TEST(SonarFiring, CountsMotionAlongTheAxisOfItsDiscOnly) {
  for (std::size_t disc = 0; disc < kRing.robot_from_sonar.size(); ++disc) {
    const double axis = kRing.robot_from_sonar[disc].theta;
    SonarFiring from = firing(disc, 1.0);
    from.odom_from_robot = {2.0, -1.0, 0.7};
    for (const double along : {0.2, -0.2}) {
      SonarFiring to = from;
      to.odom_from_robot = from.odom_from_robot * Pose2{along * std::cos(axis), along * std::sin(axis), 0.0};
      EXPECT_NEAR(moved_along_axis(kRing, from, to), 0.2, 1e-12) << disc;
      to.odom_from_robot = from.odom_from_robot * Pose2{-along * std::sin(axis), along * std::cos(axis), radians(30.0)};
      EXPECT_NEAR(moved_along_axis(kRing, from, to), 0.0, 1e-12) << disc;
    }
  }
}

}  // namespace
}  // namespace luminav
