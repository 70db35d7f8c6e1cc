#pragma once

#include <cstdint>
#include <ctime>

namespace luminav {

/// [us] by one of the host's clocks, such as CLOCK_MONOTONIC.
inline std::int64_t read_clock(clockid_t id) {
  timespec now{};
  clock_gettime(id, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000 + now.tv_nsec / 1000;
}

/// Where drivers take their time from: the host's clock in a process, a virtual one in a test or an evaluation.
class Clock {
 public:
  virtual ~Clock() = default;
  /// [us] since the epoch; never goes back.
  [[nodiscard]] virtual std::int64_t utime() const = 0;
};

/// Monotonic clock plus an offset to the epoch that is taken once per boot and shared by all drivers of the host (in a
/// small file), so that a stepped wall clock does not tear the stream of stamps.
class HostClock final : public Clock {
 public:
  HostClock();
  [[nodiscard]] std::int64_t utime() const override;

 private:
  std::int64_t offset_;  // [us]
};

/// Time that stands still until it is told to go on.
class VirtualClock final : public Clock {
 public:
  explicit VirtualClock(std::int64_t start = 1'000'000'000'000) : now_(start) {}
  [[nodiscard]] std::int64_t utime() const override { return now_; }
  void advance(std::int64_t microseconds) { now_ += microseconds; }

 private:
  std::int64_t now_;  // [us]
};

}  // namespace luminav
