#pragma once

#include <cstdint>
#include <ctime>

namespace luminav::launcher {

/// A moment on both clocks: intervals are measured on the steady one, messages carry the other.
struct Instant {
  std::int64_t steady = 0;  // [us] monotonic, for time limits
  std::int64_t utime = 0;   // [us] since the epoch, for messages

  static Instant read() { return {read_clock(CLOCK_MONOTONIC), read_clock(CLOCK_REALTIME)}; }

 private:
  static std::int64_t read_clock(clockid_t id) {
    timespec now{};
    clock_gettime(id, &now);
    return static_cast<std::int64_t>(now.tv_sec) * 1'000'000 + now.tv_nsec / 1000;
  }
};

inline constexpr std::int64_t kSecond = 1'000'000;  // [us]

}  // namespace luminav::launcher
