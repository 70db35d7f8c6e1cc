#pragma once

#include <cstdint>
#include <string>

#include "drivers/base/safety/velocity_gate.hpp"
#include "drivers/create2/oi/sensor_reading.hpp"

namespace luminav {

/// What the robot touches, what is a hole before it, and whether its wheels hang in the air. The wheels are stopped at
/// once; afterwards only what does not lead on is let through.
class HazardWatch {
 public:
  // Bits of ROBOT_STATUS.bumpers_front.
  static constexpr int kBumpLeft = 1;
  static constexpr int kBumpRight = 2;
  static constexpr int kCliffLeft = 4;
  static constexpr int kCliffFrontLeft = 8;
  static constexpr int kCliffFrontRight = 16;
  static constexpr int kCliffRight = 32;

  /// True when something has come up that was not there in the reading before.
  bool update(const SensorReading& reading);
  /// The motion must not be: forward against what is touched, anything but back from an edge, any with a wheel in the
  /// air.
  [[nodiscard]] bool forbids(const DriveVelocity& wanted) const;

  [[nodiscard]] int bumpers() const { return bumpers_; }
  [[nodiscard]] bool sees_cliff() const { return bumpers_ >= kCliffLeft; }
  [[nodiscard]] bool is_lifted() const { return lifted_; }
  /// What is the matter, one sentence; "" = nothing.
  [[nodiscard]] std::string reason() const;

 private:
  int bumpers_ = 0;
  bool lifted_ = false;
};

}  // namespace luminav
