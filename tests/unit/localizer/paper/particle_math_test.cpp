#include "services/localizer/paper/particle_math.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace luminav {
namespace {

TEST(ParticleMath, SineAndCosineAreRightToFloat) {
  for (int i = 0; i < 4096; ++i) {
    const float angle = -9.5F + 19.0F * static_cast<float>(i) / 4096.0F;
    ASSERT_NEAR(cosine(angle), std::cos(static_cast<double>(angle)), 2e-6) << angle;
    ASSERT_NEAR(sine(angle), std::sin(static_cast<double>(angle)), 2e-6) << angle;
  }
}

TEST(ParticleMath, ExponentialIsRightWhereLikelihoodsMatter) {
  for (float power = 0.0F; power > -7.0F; power -= 0.01F) {
    ASSERT_NEAR(exponential(power), std::exp(static_cast<double>(power)), 1e-3 * std::exp(static_cast<double>(power)));
  }
  EXPECT_GT(exponential(-1e6F), 0.0F);
  EXPECT_LT(exponential(-1e6F), 1e-20F);
}

TEST(ParticleMath, WrapsAnglesToHalfATurn) {
  EXPECT_NEAR(wrap_float(4.0F), 4.0 - 2.0 * 3.14159265, 1e-6);
  EXPECT_NEAR(wrap_float(-4.0F), 2.0 * 3.14159265 - 4.0, 1e-6);
  EXPECT_NEAR(wrap_float(3.0F), 3.0, 1e-6);
}

}  // namespace
}  // namespace luminav
