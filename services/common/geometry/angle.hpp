#pragma once

#include <cmath>
#include <numbers>

namespace luminav {

inline constexpr double kPi = std::numbers::pi;

/// Wraps an angle [rad] into (-period/2, period/2]; a period of 0 means "no orientation" and gives 0.
inline double wrap_modulo(double angle, double period) {
  if (period == 0.0) {
    return 0.0;
  }
  if (angle > -0.5 * period && angle <= 0.5 * period) {
    return angle;  // the usual case; std::remainder is slow
  }
  const double wrapped = std::remainder(angle, period);
  return wrapped <= -0.5 * period ? wrapped + period : wrapped;
}

/// Wraps a heading [rad] into (-pi, pi].
inline double wrap_angle(double angle) {
  return wrap_modulo(angle, 2.0 * kPi);
}

/// Wraps the direction of an axis [rad], which is the same after half a turn, into (-pi/2, pi/2].
inline double wrap_axis(double angle) {
  return wrap_modulo(angle, kPi);
}

inline constexpr double radians(double degrees) {
  return degrees * kPi / 180.0;
}
inline constexpr double degrees(double radians) {
  return radians * 180.0 / kPi;
}

}  // namespace luminav
