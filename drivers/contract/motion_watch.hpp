#pragma once

#include <cstdint>
#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/stop_t.hpp>
#include <optional>
#include <vector>

#include "drivers/contract/clause.hpp"
#include "drivers/contract/command_ledger.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// Holds what the wheels do against what they were told. Times are the base's own stamps, so no clocks need agree.
class MotionWatch {
 public:
  explicit MotionWatch(const RobotDescription& robot);

  void hear(const robot_status_t& message);
  void hear(const odometry_t& message);
  void hear(const velocity_command_t& message);
  void hear(const stop_t& message);
  [[nodiscard]] std::vector<Clause> clauses() const;

 private:
  struct Clauses {
    Clause moves{"VELOCITY_COMMAND: a fresh one moves it"};
    Clause stands{"VELOCITY_COMMAND: nothing else moves it; none for 0.3 s and it brakes"};
    Clause unpowered{"VELOCITY_COMMAND: moves nothing while the motors are off"};
    Clause limits{"ODOMETRY: never faster than ROBOT_STATUS says it may be"};
    Clause fresh{"ROBOT_STATUS: command_fresh while a command is obeyed, and only then"};
    Clause refused{"ROBOT_STATUS: commands_refused counts what is old, repeated or sideways"};
    Clause stop{"STOP: it brakes and stands, whatever is commanded"};
  };
  struct Speeds {
    std::int64_t since = 0;  // [us] of the first
    int count = 0;
    double linear = 0.0;   // [m/s] their sum
    double angular = 0.0;  // [rad/s] likewise
  };
  [[nodiscard]] double braking_time(double linear, double angular) const;  // [s]
  [[nodiscard]] double time_to_brake() const;                              // [s] from what it does and is told now
  [[nodiscard]] double age(std::int64_t since, std::int64_t now) const;    // [s]
  void judge_limits(const odometry_t& message);
  void judge_standing(const odometry_t& message, bool moves);
  void judge_moving(const odometry_t& message);
  void judge_refusals(const robot_status_t& message);

  MotionLimits limits_;
  CommandLedger ledger_;
  std::optional<robot_status_t> status_;
  odometry_t odometry_{};
  std::int64_t began_ = 0;          // [us] first ROBOT_STATUS
  std::int64_t motors_since_ = 0;   // [us] on or off, as they are now
  std::int64_t stopped_since_ = 0;  // [us] STOP engaged; 0 = it is not
  std::int64_t released_at_ = 0;    // [us]
  std::int64_t unsound_since_ = 0;  // [us] first command to be refused that no ROBOT_STATUS was held against
  std::int64_t refused_before_ = 0;
  Speeds speeds_;
  double brake_ = 0.0;  // [s] it needs from its speed at the last command or STOP
  Clauses clauses_;
};

}  // namespace luminav
