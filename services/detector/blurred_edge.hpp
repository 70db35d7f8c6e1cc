#pragma once

#include <algorithm>

namespace luminav {

/// How much of a blurred edge's far side is seen, `outside` [m] of it; `width` [m] from its foot to its top.
inline double blurred_step(double outside, double width) {
  const double t = std::clamp(0.5 + outside / width, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace luminav
