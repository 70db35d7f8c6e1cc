#include "services/common/geometry/angle.hpp"

#include <gtest/gtest.h>

namespace luminav {
namespace {

TEST(Angle, WrapsIntoTheHalfOpenInterval) {
  EXPECT_DOUBLE_EQ(wrap_angle(0.0), 0.0);
  EXPECT_DOUBLE_EQ(wrap_angle(kPi), kPi);
  EXPECT_DOUBLE_EQ(wrap_angle(-kPi), kPi);
  EXPECT_NEAR(wrap_angle(3.0 * kPi), kPi, 1e-12);
  EXPECT_NEAR(wrap_angle(-1.5 * kPi), 0.5 * kPi, 1e-12);
}

TEST(Angle, WrapsAnAxisModuloHalfATurn) {
  EXPECT_NEAR(wrap_axis(radians(170.0)), radians(-10.0), 1e-12);
  EXPECT_NEAR(wrap_axis(radians(-90.0)), radians(90.0), 1e-12);
}

TEST(Angle, HasNoOrientationWithPeriodZero) {
  EXPECT_DOUBLE_EQ(wrap_modulo(1.234, 0.0), 0.0);
}

TEST(Angle, KeepsTheDifferenceToAMultipleOfThePeriod) {
  for (double angle = -20.0; angle < 20.0; angle += 0.37) {
    for (const double period : {kPi / 2.0, kPi, 2.0 * kPi}) {
      const double turns = (angle - wrap_modulo(angle, period)) / period;
      EXPECT_NEAR(turns, std::round(turns), 1e-9);
      EXPECT_LE(std::abs(wrap_modulo(angle, period)), 0.5 * period + 1e-12);
    }
  }
}

}  // namespace
}  // namespace luminav
