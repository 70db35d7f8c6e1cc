#pragma once

#include <limits>

namespace luminav {

/// std::floor as an int, without the library call that it is on the plainest machines. Of what does not fit the result
/// is some int.
inline int floor_to_int(double x) {
  const int cut = static_cast<int>(x);
  return cut - (x < cut && cut != std::numeric_limits<int>::min() ? 1 : 0);
}

/// std::ceil as an int, likewise.
inline int ceil_to_int(double x) {
  const int cut = static_cast<int>(x);
  return cut + (x > cut && cut != std::numeric_limits<int>::max() ? 1 : 0);
}

}  // namespace luminav
