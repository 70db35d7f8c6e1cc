#pragma once

#include <cstdint>
#include <functional>
#include <utility>

#include "services/common/process/clock.hpp"

namespace luminav {

/// How a driver tells its guardian that it lives, and how it knows that it was too late: what the guardian then did on
/// the line has to be undone first.
class LifeSign {
 public:
  /// `silence` [s] after which the guardian acts; `done_after` [s] of silence it has left the line, 0 = there is none.
  LifeSign(double silence, double done_after) : silence_(silence), done_after_(done_after) {}

  void report_to(std::function<void()> tell_guardian) { tell_guardian_ = std::move(tell_guardian); }
  /// Tells it, each 55 ms. To be called often.
  void beat(const Clock& clock);
  /// It heard nothing for so long, now or before the last beat came through.
  [[nodiscard]] bool guardian_may_have_acted(std::int64_t now) const { return was_late_ || heard_nothing(now); }
  /// [us] when it has left the line.
  [[nodiscard]] std::int64_t guardian_done_at() const {
    return last_beat_ + static_cast<std::int64_t>(1e6 * done_after_);
  }
  /// What it did is undone.
  void forget() {
    was_late_ = false;
    last_beat_ = 0;
  }

 private:
  [[nodiscard]] bool heard_nothing(std::int64_t now) const;

  double silence_;     // [s]
  double done_after_;  // [s]
  std::function<void()> tell_guardian_;
  std::int64_t last_beat_ = 0;  // [us] just before the guardian was told; 0 = not yet
  bool was_late_ = false;
};

}  // namespace luminav
