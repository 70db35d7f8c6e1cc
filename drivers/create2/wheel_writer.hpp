#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/base/safety/velocity_gate.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// Turns velocities into wheel speeds. The robot takes each speed at once, so the ramps of its file are made here; and
/// it keeps the last one for ever, so nothing but this and the guardian makes it brake.
class WheelWriter {
 public:
  WheelWriter(const MotionLimits& limits, double wheel_base) : limits_(limits), wheel_base_(wheel_base) {}

  /// The command due now, 50 times a second while the speed changes and each 0.1 s else; `now` [us].
  std::optional<std::vector<std::uint8_t>> poll(const DriveVelocity& wanted, std::int64_t now);
  /// From now on it stands, without a ramp; the command for it.
  std::vector<std::uint8_t> halt(std::int64_t now);
  /// The robot may have missed everything, and stands.
  void restart();

 private:
  MotionLimits limits_;
  double wheel_base_;           // [m]
  DriveVelocity velocity_;      // as the ramps have it
  int left_mm_s_ = 0;           // as sent
  int right_mm_s_ = 0;          // as sent
  std::int64_t ramped_at_ = 0;  // [us]
  std::int64_t sent_at_ = 0;    // [us] 0 = is due
};

}  // namespace luminav
