#pragma once

#include <algorithm>
#include <cstdint>

namespace luminav {

/// When a line that was lost is opened again: at first soon, then with delays that double.
class RetrySchedule {
 public:
  static constexpr std::int64_t kLongest = 2'000'000;  // [us] driving again within 3 s of the line being back

  /// The line was lost, or could not be opened.
  void fail(std::int64_t now) {
    const std::int64_t delay = kFirst << std::clamp(failures_ - kQuickRetries, 0, 6);
    ++failures_;
    at_ = now + std::min(delay, kLongest);
  }
  void succeed() { failures_ = 0; }
  /// Not before that time [us], whatever has failed.
  void wait_until(std::int64_t at) { at_ = at; }
  [[nodiscard]] bool is_due(std::int64_t now) const { return now >= at_; }

 private:
  static constexpr std::int64_t kFirst = 50'000;  // [us]
  static constexpr int kQuickRetries = 20;  // a guardian of a driver that died holds the line for less than a second
  int failures_ = 0;                        // in a row
  std::int64_t at_ = 0;                     // [us]
};

}  // namespace luminav
