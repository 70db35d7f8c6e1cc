#include "services/controller/following/steady_heading.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

/// Nothing stands anywhere: what is chosen follows from the wish and from what was chosen before.
class SteadyHeadingTest : public ::testing::Test {
 protected:
  double choose(double wish, double theta, double duration) { return heading_.choose(wish, 0.9, theta, duration, {}); }

  SteadyHeading heading_{{.free_heading = {}, .smoothing = 0.2, .jump = radians(20.0)}};
};

TEST_F(SteadyHeadingTest, TakesTheFirstChoiceAtOnce) {
  EXPECT_NEAR(choose(0.3, 1.0, 0.05), 0.3, 1e-9);
}

TEST_F(SteadyHeadingTest, FollowsASmallChangeSlowly) {
  choose(0.0, 0.0, 0.1);
  EXPECT_NEAR(choose(0.1, 0.0, 0.1), 0.05, 1e-9);
  EXPECT_NEAR(choose(0.1, 0.0, 0.1), 0.075, 1e-9);
}

TEST_F(SteadyHeadingTest, FollowsAJumpAtOnce) {
  choose(0.0, 0.0, 0.05);
  EXPECT_NEAR(choose(1.0, 0.0, 0.05), 1.0, 1e-9);
}

TEST_F(SteadyHeadingTest, KeepsToItsLastChoice) {
  choose(0.0, 0.0, 10.0);
  // 0.2 is as near to the last one as need be; the tenth of a radian to the wish costs less than to leave it
  EXPECT_NEAR(choose(0.3, 0.0, 10.0), 0.2, 1e-9);
  EXPECT_NEAR(choose(0.3, 0.0, 10.0), 0.3, 1e-9) << "and from there the wish is near";
}

TEST_F(SteadyHeadingTest, DoesNotTurnWithTheRobot) {
  choose(0.2, 0.0, 0.05);
  EXPECT_NEAR(choose(0.0, 0.2, 0.05), 0.0, 1e-9);
}

TEST_F(SteadyHeadingTest, GoesAcrossPi) {
  choose(0.1, kPi - 0.05, 0.05);
  EXPECT_NEAR(choose(0.03, -kPi + 0.02, 0.05), 0.03, 1e-9);
}

TEST_F(SteadyHeadingTest, StandsStillInNoTime) {
  choose(0.0, 0.0, 0.05);
  EXPECT_NEAR(choose(0.1, 0.0, 0.0), 0.0, 1e-9);
}

TEST_F(SteadyHeadingTest, ForgetsOnReset) {
  choose(0.0, 0.0, 0.05);
  heading_.reset();
  EXPECT_NEAR(choose(0.1, 0.0, 0.05), 0.1, 1e-9);
}

}  // namespace
}  // namespace luminav
