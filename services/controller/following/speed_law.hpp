#pragma once

#include "services/common/configuration/robot_file.hpp"
#include "services/controller/safety/footprint.hpp"

namespace luminav {

struct SpeedLawParams {
  double linear = 0.5;             // [m/s] on a free stretch
  double angular = radians(60.0);  // [rad/s]
  double turn_gain = 1.6;          // [1/s] turning speed per heading error
  double wide = 0.20;              // [m] clearance that does not slow it down
};

/// Twist towards a heading: turning speed in proportion to the error, speed falling with error, with little clearance
/// and towards the end of the path. `heading_error` [rad], `clearance` [m] from the outline, `distance_left` [m].
DriveTwist speed_law(double heading_error, double clearance, double distance_left, const SpeedLawParams& params);

/// Slews a command towards a wish within the robot's accelerations; slowing down uses the deceleration and is never
/// softened, speeding up starts softly: acceleration grows by `jerk` at most.
class CommandRamp {
 public:
  CommandRamp(const MotionLimits& limits, double jerk) : limits_(limits), jerk_(jerk) {}
  /// `duration` [s] since the last step.
  DriveTwist step(const DriveTwist& wanted, double duration);
  /// Replaces the last step, from where that began and over the same time.
  DriveTwist step_again(const DriveTwist& wanted);
  /// Stands still from now on.
  void stop();
  /// What was driven in the end, after the stop logic.
  void restart_from(const DriveTwist& driven);

 private:
  MotionLimits limits_;
  double jerk_;  // [m/s^3]
  DriveTwist current_;
  double acceleration_ = 0.0;  // [m/s^2]
  // what the last step began with, and its duration [s]
  DriveTwist current_before_;
  double acceleration_before_ = 0.0;
  double duration_ = 0.0;
};

}  // namespace luminav
