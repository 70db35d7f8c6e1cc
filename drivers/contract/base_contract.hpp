#pragma once

#include <cstdint>
#include <luminav/node_status_t.hpp>
#include <string>
#include <vector>

#include "drivers/contract/clause.hpp"
#include "drivers/contract/motion_watch.hpp"
#include "drivers/contract/odometry_watch.hpp"
#include "drivers/contract/request_watch.hpp"
#include "drivers/contract/ring_watch.hpp"
#include "drivers/contract/stream_watch.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// The contract between a base driver and the rest (docs/base-drivers.md), held against every message that passes.
/// Knows no driver: what was commanded it has heard, too. Arrivals are of one clock of the listener's [us].
class BaseContract {
 public:
  /// `process` is the driver's name in NODE_STATUS.
  BaseContract(const RobotDescription& robot, const std::string& process);

  void hear(const odometry_t& message, std::int64_t arrival);
  void hear(const sonar_t& message, std::int64_t arrival);
  void hear(const robot_status_t& message, std::int64_t arrival);
  void hear(const node_status_t& message, std::int64_t arrival);
  void hear(const velocity_command_t& message) { motion_.hear(message); }
  void hear(const stop_t& message);
  void hear(const motors_command_t& message) { requests_.hear(message); }

  [[nodiscard]] std::vector<Clause> clauses() const;

 private:
  void judge_status(const robot_status_t& message);

  RobotDescription robot_;
  std::string process_;
  StreamWatch odometry_stream_{{"ODOMETRY", 10.0, 0.3}};
  StreamWatch sonar_stream_{{"SONAR", 10.0, 0.3}};
  StreamWatch status_stream_{{"ROBOT_STATUS", 50.0, 0.1}};
  OdometryWatch odometry_;
  RingWatch ring_;
  MotionWatch motion_;
  RequestWatch requests_;
  std::int64_t node_first_ = 0;  // [us] arrival of the driver's first NODE_STATUS
  std::int64_t node_last_ = 0;   // [us]
  int node_count_ = 0;
  Clause name_{"ROBOT_STATUS: the robot's name from its file"};
  Clause limits_{"ROBOT_STATUS: limits and deceleration in force, none above the robot's file"};
  Clause reason_{"ROBOT_STATUS: a reason while it may not move"};
};

}  // namespace luminav
