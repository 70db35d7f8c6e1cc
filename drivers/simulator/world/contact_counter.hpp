#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "drivers/simulator/world/scene.hpp"

namespace luminav {

/// Counts contacts as events: a new one begins only after the robot was separated from that kind of thing. With a
/// person it counts unless the robot had stood still for half a second.
class ContactCounter {
 public:
  /// The robot's motion during the last `dt` seconds.
  void observe_motion(double dt, double linear, double angular) {
    constexpr double kStandstill = 0.02;  // [m/s], [rad/s]
    still_for_ = std::abs(linear) < kStandstill && std::abs(angular) < kStandstill ? still_for_ + dt : 0.0;
  }

  /// The robot tried to move into what has no separation left; true when that begins a contact. One of a bumper at
  /// walking speed is `gentle`: counted with those that are hard to sense.
  bool touch(const Separation& attempted, bool gentle = false) {
    bool begins = false;
    for (std::size_t kind = 0; kind < kSolidKinds; ++kind) {
      if (attempted.of[kind] > 0.0 || touching_[kind]) {
        continue;
      }
      touching_[kind] = true;
      begins = true;
      const auto solid = static_cast<SolidKind>(kind);
      if (solid == SolidKind::kHard || gentle) {
        ++hard_contacts_;
      } else if (solid != SolidKind::kPerson || still_for_ < kExcused) {
        ++contacts_;
      }
    }
    return begins;
  }

  /// Whether a wheel hangs over an edge: worse than any contact, counted when it begins.
  void observe_fall(bool hangs) {
    contacts_ += hangs && !has_fallen_ ? 1 : 0;
    has_fallen_ = hangs;
  }

  /// Where the robot stands now.
  void release(const Separation& separation) {
    constexpr double kApart = 0.01;  // [m]
    for (std::size_t kind = 0; kind < kSolidKinds; ++kind) {
      touching_[kind] = touching_[kind] && separation.of[kind] <= kApart;
    }
  }

  [[nodiscard]] bool touching() const {
    bool any = false;
    for (const bool kind : touching_) {
      any = any || kind;
    }
    return any;
  }
  [[nodiscard]] std::int32_t contacts() const { return contacts_; }
  [[nodiscard]] std::int32_t hard_contacts() const { return hard_contacts_; }

 private:
  static constexpr double kExcused = 0.5;  // [s]
  std::array<bool, kSolidKinds> touching_{};
  bool has_fallen_ = false;
  double still_for_ = 0.0;  // [s]
  std::int32_t contacts_ = 0;
  std::int32_t hard_contacts_ = 0;
};

}  // namespace luminav
