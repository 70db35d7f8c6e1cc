#pragma once

#include <optional>
#include <string>

#include "services/common/configuration/robot_file.hpp"
#include "services/controller/safety/echo_memory.hpp"
#include "services/controller/safety/obstacles.hpp"

namespace luminav {

struct StopLogicParams {
  double margin = 0.06;            // [m] nothing may come nearer to the outline by the robot's own motion
  double known_margin = 0.04;      // [m] the same for mapped walls, whose place is known to half a cell
  double time_to_contact = 1.1;    // [s] at the commanded speed; slower commands look less far
  double reaction_time = 0.25;     // [s] from a command to the wheels
  double silent_after = 0.5;       // [s] without odometry or sonar
  double disc_silent_after = 0.9;  // [s] without a firing: the sector is blind
  double doubtful_linear = 0.15;   // [m/s] while some sonars seem to be dead
  double bumper_linear = 0.2;      // [m/s] of a robot without sonars, which feels with its bumper
};

/// Ages of the readings by direction, and what the bumpers feel.
struct SenseAges {
  double odometry = 1e9;      // [s]
  double sonar = 1e9;         // [s] newest firing of any disc
  double front_sonar = 1e9;   // [s] oldest of the discs that look ahead
  double rear_sonar = 1e9;    // [s] oldest of the discs that look back; 1e9 = there are none
  bool front_bumper = false;  // pressed
  bool rear_bumper = false;   // pressed
  std::string doubt{};        // why some sonars seem to be dead; "" = none does
  bool has_sonar = true;      // false: the robot's file has none, it goes by map and bumper
};

/// Whether there is a ring, and the ages of its discs that look within 45 degrees of straight ahead and straight back.
void judge_disc_ages(const EchoMemory& echoes, std::int64_t now, SenseAges& ages);

/// It sees what is behind; or it has no sonars at all and goes back over ground that it has just left.
inline bool may_back(const SenseAges& ages, const StopLogicParams& params) {
  return !ages.has_sonar || ages.rear_sonar < params.disc_silent_after;
}

struct StopVerdict {
  DriveTwist twist;         // what may be driven
  bool limited = false;     // less than what was wanted
  bool blocked = false;     // no motion forward or backward is left of one that was wanted
  bool by_unknown = false;  // what limits it is on no map: a person perhaps
  std::string reason;       // plain sentence; "" when not limited
};

/// The last word on every command, whoever wants it: wander, path or person. Shortens a twist until its arc keeps the
/// margin for the time to contact; what only leads away from an obstacle is always allowed, so that a stop never wedges
/// the robot.
class StopLogic {
 public:
  StopLogic(const RobotDescription& robot, const StopLogicParams& params);

  [[nodiscard]] StopVerdict judge(const DriveTwist& wanted, const Obstacles& obstacles, const SenseAges& ages) const;
  /// True if the arc of a twist, driven for a time [s], keeps the margins.
  [[nodiscard]] bool is_free(const DriveTwist& twist, double duration, const Obstacles& obstacles) const;
  /// Distance [m] from the outline to the nearest obstacle; 10 = none.
  [[nodiscard]] double clearance(const Obstacles& obstacles) const;

  [[nodiscard]] const Footprint& footprint() const { return footprint_; }

 private:
  /// The first obstacle on an arc, or nothing.
  [[nodiscard]] std::optional<std::size_t> first_obstruction(const DriveTwist& twist, double duration,
                                                             const Obstacles& obstacles) const;
  [[nodiscard]] double look_ahead_time(const DriveTwist& twist) const;

  Footprint footprint_;
  MotionLimits limits_;
  StopLogicParams params_;
};

}  // namespace luminav
