#pragma once

#include <cstdint>

namespace luminav {

/// Converts a duration [us], as stamps have it, to [s].
constexpr double seconds_of(std::int64_t microseconds) {
  return 1e-6 * static_cast<double>(microseconds);
}

/// [s] from one stamp [us] to another; negative where the second one is earlier.
constexpr double seconds_between(std::int64_t from, std::int64_t to) {
  return seconds_of(to - from);
}

/// Converts a duration [s] to [us], cut.
constexpr std::int64_t microseconds_of(double seconds) {
  return static_cast<std::int64_t>(seconds * 1e6);
}

}  // namespace luminav
