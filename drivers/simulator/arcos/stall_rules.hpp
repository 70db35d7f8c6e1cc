#pragma once

#include <cstdint>

#include "drivers/simulator/base_board.hpp"

namespace luminav {

/// What stalls the simulated controller's motors: blocked wheels let them rest for a while, bumpers where BUMP_STALL
/// asks for it, and the stop button switches them off where E_STALL does.
class StallRules {
 public:
  /// `rest` [us] after a stall.
  explicit StallRules(std::int64_t rest) : rest_(rest) {}

  void set_stop_button(bool stalls) { stop_button_ = stalls; }
  /// Bit 0 the front bumpers, bit 1 those at the rear.
  void set_bumpers(int mask) { bumpers_ = mask; }

  [[nodiscard]] bool is_stopped(const BoardInputs& inputs) const { return inputs.stop_button && stop_button_; }
  /// `linear` [m/s] in force: bumpers stall only what drives towards what they touch.
  void sense(const BoardInputs& inputs, double linear) {
    const bool bumped = (inputs.bumpers_front != 0 && (bumpers_ & 1) != 0 && linear > 0.0) ||
                        (inputs.bumpers_rear != 0 && (bumpers_ & 2) != 0 && linear < 0.0);
    if (inputs.stall_left || inputs.stall_right || bumped) {
      remaining_ = rest_;
    }
  }
  [[nodiscard]] bool is_resting() const { return remaining_ > 0; }
  void step(std::int64_t microseconds) { remaining_ -= is_resting() ? microseconds : 0; }

 private:
  std::int64_t rest_;
  std::int64_t remaining_ = 0;  // [us] that they still rest
  bool stop_button_ = true;
  int bumpers_ = 0;
};

}  // namespace luminav
