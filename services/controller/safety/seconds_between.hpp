#pragma once

#include <cstdint>

namespace luminav {

/// From one stamp [us] to another; negative where the second one is earlier.
inline double seconds_between(std::int64_t from, std::int64_t to) {
  return 1e-6 * static_cast<double>(to - from);
}

}  // namespace luminav
