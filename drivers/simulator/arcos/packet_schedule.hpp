#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace luminav {

/// What the simulated controller sends unasked: information in each cycle, and along with it what the client requested.
class PacketSchedule {
 public:
  enum Companion : std::size_t { kEncoders, kInputOutput };

  /// A session begins; `cycle` [ms] of the information.
  explicit PacketSchedule(int cycle) : period_(1000 * std::max(cycle, 10)), remaining_(1000 * cycle) {}

  /// 0 never, 1 once, 2 with each information packet.
  void request(Companion packet, int mode) { modes_[packet] = std::clamp(mode, 0, 2); }
  /// Whether information is due when time goes on by `microseconds`.
  [[nodiscard]] bool step(std::int64_t microseconds) {
    remaining_ -= microseconds;
    const bool is_due = remaining_ <= 0;
    remaining_ += is_due ? period_ : 0;
    return is_due;
  }
  /// Whether it goes with the information of now.
  [[nodiscard]] bool take(Companion packet) {
    const int mode = modes_[packet];
    modes_[packet] = mode == 1 ? 0 : mode;
    return mode > 0;
  }

 private:
  std::int64_t period_;     // [us]
  std::int64_t remaining_;  // [us]
  std::array<int, 2> modes_{};
};

}  // namespace luminav
