#pragma once

#include <cstdint>

// Functions of float without tables, calls or jumps: in a loop over arrays the compiler makes vector instructions of
// them, and their bytes are the same on every machine, as those of the standard library need not be.
namespace luminav {

inline constexpr float kFloatPi = 3.14159265358979F;

inline float nearest_integer(float a) {
  return static_cast<float>(static_cast<std::int32_t>(a + (a < 0.0F ? -0.5F : 0.5F)));
}

/// The angle between -pi and pi that is the same [rad].
inline float wrap_float(float angle) {
  return angle - 2.0F * kFloatPi * nearest_integer(0.5F / kFloatPi * angle);
}

/// Of an angle of up to a few turns [rad]. Taylor's series between -pi/2 and pi/2; error below 1e-6.
inline float sine(float angle) {
  const float a = wrap_float(angle);
  const float folded = a > 0.5F * kFloatPi ? kFloatPi - a : a < -0.5F * kFloatPi ? -kFloatPi - a : a;
  const float z = folded * folded;
  const float tail = 1.0F / 362880.0F - z * (1.0F / 39916800.0F);
  return folded * (1.0F - z * (1.0F / 6.0F - z * (1.0F / 120.0F - z * (1.0F / 5040.0F - z * tail))));
}

inline float cosine(float angle) {
  return sine(angle + 0.5F * kFloatPi);
}

/// e to the power of a number not above 0; below -60 it stays there. (1 + y + y^2 / 2)^256 with y = a / 256: relative
/// error below 1e-3 down to -7.
inline float exponential(float a) {
  const float y = (a > -60.0F ? a : -60.0F) * (1.0F / 256.0F);
  float power = 1.0F + y + 0.5F * y * y;
  for (int doubling = 0; doubling < 8; ++doubling) {
    power *= power;
  }
  return power;
}

}  // namespace luminav
