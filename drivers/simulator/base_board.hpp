#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace luminav {

/// What the controller of a simulated base senses in one step.
struct BoardInputs {
  double left_travel = 0.0;  // [m] of the wheel since the last step, as the encoder sees it
  double right_travel = 0.0;
  bool stall_left = false;  // the wheel is blocked
  bool stall_right = false;
  int bumpers_front = 0;  // bit mask, bit 0 = leftmost
  int bumpers_rear = 0;
  int cliffs = 0;  // bit mask: the floor ends before it, bit 0 = leftmost of four sensors
  bool wheel_drop_left = false;
  bool wheel_drop_right = false;
  bool stop_button = false;       // held down
  bool motors_button = false;     // held down; each press toggles the motors
  double battery_voltage = 12.6;  // [V]
  int charge_state = 0;           // 0 none, 1 bulk, 2 overcharge, 3 float
};

/// What it does with the robot until the next step.
struct BoardOutputs {
  double linear = 0.0;           // [m/s] after its ramps
  double angular = 0.0;          // [rad/s]
  bool motors_enabled = false;   // false: the wheels have no power
  std::vector<int> sonar_discs;  // that fire now, counted from 0
};

/// The controller of a simulated base: bytes and wheel travel in, bytes and wheel speeds out. Neither I/O nor clock.
class BaseBoard {
 public:
  BaseBoard() = default;
  BaseBoard(const BaseBoard&) = default;
  BaseBoard& operator=(const BaseBoard&) = default;
  virtual ~BaseBoard() = default;

  /// Bytes from the client, in pieces of any size.
  virtual void receive(std::span<const std::uint8_t> bytes) = 0;
  /// Time goes on by `dt` [s]; call it every 10 ms.
  virtual BoardOutputs step(double dt, const BoardInputs& inputs) = 0;
  /// The answer for a disc that fired: distance of the echo [m].
  virtual void set_sonar_reading(int disc, double range) = 0;
  /// Bytes for the client since the last call.
  virtual std::vector<std::uint8_t> take_output() = 0;
  /// The network connection to the client is gone; a serial line cannot tell.
  virtual void on_line_closed() = 0;
  /// Rate of the serial line [bit/s].
  [[nodiscard]] virtual int baud() const = 0;
};

}  // namespace luminav
