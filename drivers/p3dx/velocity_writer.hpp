#pragma once

#include <cstdint>
#include <vector>

#include "drivers/base/safety/velocity_gate.hpp"

namespace luminav {

/// Turns velocities into VEL and RVEL frames. The robot knows whole mm/s and whole degrees/s only: the turn rate
/// alternates between its neighbours so that the angle turned is right (error diffusion over time), 20 times a second.
class VelocityWriter {
 public:
  /// Frames due now; `now` [us]. A change leaves at once, but no more of them than one each 15 ms on average.
  std::vector<std::vector<std::uint8_t>> poll(const DriveVelocity& wanted, std::int64_t now);
  /// The robot may have forgotten or missed everything: both frames are due at the next poll.
  void restart();

 private:
  [[nodiscard]] int choose_turn_rate(double wanted_deg, std::int64_t now);

  bool known_ = false;  // the robot has our last values
  DriveVelocity wanted_;
  int velocity_mm_s_ = 0;                 // as sent
  int turn_rate_deg_s_ = 0;               // as sent
  double angle_error_deg_ = 0.0;          // asked for and not yet turned
  std::int64_t last_cycle_ = 0;           // [us]
  double change_allowance_ = 0.0;         // changes that may leave now
  std::int64_t change_allowance_at_ = 0;  // [us]
  std::int64_t last_velocity_ = 0;        // [us] when VEL was sent
  std::int64_t last_turn_rate_ = 0;       // [us]
};

}  // namespace luminav
