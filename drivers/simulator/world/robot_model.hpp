#pragma once

#include "drivers/simulator/geometry/random_stream.hpp"
#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// What the microcontroller asks of the motors.
struct MotorCommand {
  double linear = 0.0;   // [m/s]
  double angular = 0.0;  // [rad/s]
  bool enabled = false;  // false: the wheels have no power and roll out
};

/// One step of the wheels and what it moves on the ground if nothing is in the way.
struct WheelStep {
  double left = 0.0;      // [m] as the encoder reports it
  double right = 0.0;     // [m]
  Pose2 robot_from_next;  // true motion
};

/// A differential drive whose wheels are not what the microcontroller believes: scale, ratio and base are wrong by
/// constants, and ground motion differs from wheel travel by a noise whose variance grows with the way (Thrun et al.
/// 2005, 5.4), drawn anew each 5 cm. Wheels that stand make no noise. The caster is left out.
class RobotModel {
 public:
  RobotModel(const WorldTruth& truth, std::uint64_t seed);

  WheelStep step(double dt, const MotorCommand& command);
  /// Ground covered per wheel travel, 1 = no slip.
  void set_grip(double grip) { grip_ = grip; }
  /// The wheels are blocked and stand at once.
  void stall() { left_speed_ = right_speed_ = 0.0; }
  /// The robot is held while its wheels are driven; what they do then is drawn when it `begins`. True when they spin,
  /// else they stall.
  bool hold(bool begins);

 private:
  void draw_noise();

  double believed_base_;  // [m]
  double true_base_;      // [m]
  double scale_left_;
  double scale_right_;
  double noise_position_;  // [m per sqrt m]
  double noise_heading_;   // [rad per sqrt m]
  RandomStream random_;
  RandomStream hold_random_;
  bool spins_when_held_ = false;
  double grip_ = 1.0;
  double left_speed_ = 0.0;      // [m/s] of the encoders
  double right_speed_ = 0.0;     // [m/s]
  double noise_distance_ = 0.0;  // [m] that the present noise still holds
  double stretch_ = 0.0;         // present noise: metres per metre
  double twist_ = 0.0;           // present noise: radians per metre
};

}  // namespace luminav
