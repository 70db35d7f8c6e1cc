#include "drivers/simulator/arcos/stall_rules.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(StallRules, LetTheMotorsRestAfterTheWheelsWereBlocked) {
  StallRules rules(200'000);
  rules.sense({}, 0.3);
  EXPECT_FALSE(rules.is_resting());
  rules.sense({.stall_right = true}, 0.0);
  rules.step(199'999);
  EXPECT_TRUE(rules.is_resting());
  rules.step(1);
  EXPECT_FALSE(rules.is_resting());
}

TEST(StallRules, HeedABumperThatIsAskedForAndOnlyOnTheWayTowardsIt) {
  const BoardInputs front{.bumpers_front = 4};
  StallRules rules(200'000);
  rules.sense(front, 0.3);
  EXPECT_FALSE(rules.is_resting());
  rules.set_bumpers(1);
  rules.sense(front, -0.3);
  rules.sense({.bumpers_rear = 4}, -0.3);
  EXPECT_FALSE(rules.is_resting());
  rules.sense(front, 0.3);
  EXPECT_TRUE(rules.is_resting());
}

TEST(StallRules, LetTheStopButtonStopUnlessToldOtherwise) {
  StallRules rules(0);
  EXPECT_FALSE(rules.is_stopped({}));
  EXPECT_TRUE(rules.is_stopped({.stop_button = true}));
  rules.set_stop_button(false);
  EXPECT_FALSE(rules.is_stopped({.stop_button = true}));
}

}  // namespace
}  // namespace luminav
