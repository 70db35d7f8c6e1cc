#pragma once

#include <cmath>
#include <cstdint>
#include <luminav/teleop_command_t.hpp>
#include <optional>

#include "services/common/geometry/seconds.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/controller/safety/footprint.hpp"

namespace luminav {

/// What a person who steers by hand wants: his newest command holds for 0.3 s, and for a second after it the robot does
/// not drive by itself.
class HeldTeleoperation {
 public:
  /// False for one that is repeated or not a number. One whose stamp is far from `now` [us] steers nothing.
  bool take(const teleop_command_t& message, std::int64_t now) {
    const bool is_repeated = newest_ && newest_->session == message.session && message.sequence <= newest_->sequence;
    if (!all_finite({message.linear, message.angular}) || is_repeated) {
      return false;
    }
    newest_ = message;
    if (std::abs(seconds_between(message.utime, now)) <= kHeld) {
      until_ = message.utime + microseconds_of(kHeld);
    }
    return true;
  }
  void clear() { *this = {}; }

  /// A person steers, or has let go just now.
  [[nodiscard]] bool is_steered(std::int64_t utime) const { return utime <= until_ + microseconds_of(kPause); }
  /// Nothing when he has let go.
  [[nodiscard]] std::optional<DriveTwist> at(std::int64_t utime) const {
    return newest_ && utime <= until_ ? std::optional(DriveTwist{newest_->linear, newest_->angular}) : std::nullopt;
  }

 private:
  static constexpr double kHeld = 0.3;   // [s] dead man
  static constexpr double kPause = 1.0;  // [s]
  std::optional<teleop_command_t> newest_;
  std::int64_t until_ = 0;  // [us] a person drove until then
};

}  // namespace luminav
