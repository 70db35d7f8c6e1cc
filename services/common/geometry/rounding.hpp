#pragma once

#include <algorithm>

namespace luminav {

/// Beyond it there is no cell of any grid, and room is left to count on from there without leaving the int.
inline constexpr double kFarthestInt = 1e9;

/// std::floor as an int, without the library call that it is on the plainest machines. What lies beyond `kFarthestInt`
/// becomes that, with its sign; what is not a number -`kFarthestInt`.
inline int floor_to_int(double x) {
  const double near = std::min(kFarthestInt, std::max(-kFarthestInt, x));
  const int cut = static_cast<int>(near);
  return cut - (near < cut ? 1 : 0);
}

/// std::ceil as an int, likewise.
inline int ceil_to_int(double x) {
  const double near = std::min(kFarthestInt, std::max(-kFarthestInt, x));
  const int cut = static_cast<int>(near);
  return cut + (near > cut ? 1 : 0);
}

}  // namespace luminav
