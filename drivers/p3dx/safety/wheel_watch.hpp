#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "drivers/base/safety/velocity_gate.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"

namespace luminav {

struct WheelWatchParams {
  double wheel_base = 0.33;  // [m]
  double asked = 0.08;       // [m/s] a wheel that is told to go as fast turns on any floor
  double counted = 0.01;     // [m/s] of the encoder, less is nothing
  double rest = 0.02;        // [m/s] a wheel that is told to stand
  double running = 0.10;     // [m/s] of the encoder while it is
  double dead_after = 0.9;   // [s] not counted; longer than the robot takes to brake from full speed
  double runs_after = 1.2;   // [s] counted although it was told to stand; longer than that too
};

/// Compares what each wheel is told with what its encoder counts. The robot holds its speed by the encoders: where one
/// is dead, or counts backwards, it drives that wheel faster and faster, and the odometry turns where the robot
/// doesn't. A wheel is dead unless both are silent: then the robot is held, carried, or without power.
class WheelWatch {
 public:
  explicit WheelWatch(const WheelWatchParams& params) : params_(params) {}

  /// What is commanded with the wheel speeds of a packet. Motors that are off and wheels that say that they are blocked
  /// are no news.
  void update(const InformationPacket& packet, const DriveVelocity& commanded, std::int64_t utime);
  /// What the first wheel does that does not do what it is told, one sentence; stays until `restart`. "" = none does.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  void restart();
  /// What was told is not known of the packets so far.
  void forget_motion();

 private:
  struct Wheel {
    bool is_told = false;    // to turn at all
    bool must_turn = false;  // fast enough, as it was told
    bool turns_so = false;   // counted, and in that direction
    double dead = 0.0;       // [s] told to turn, and not counted so, though nothing says that the robot is held
    double running = 0.0;    // [s] told to stand, and counted
  };
  void look_for_hands(double passed);
  void look(Wheel& wheel, double asked, double counted, double passed) const;
  void judge(Wheel& wheel, const Wheel& other, const char* name, double passed);

  WheelWatchParams params_;
  std::array<Wheel, 2> wheels_;
  double held_ = 0.0;       // [s] for which the robot still counts as held or carried
  std::int64_t utime_ = 0;  // [us] of the last packet; 0 = none
  std::string fault_;
};

}  // namespace luminav
