#pragma once

#include <filesystem>
#include <string>

#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// What every driver of a base is told by the robot's file and its command line.
struct BaseConfig {
  std::string device = "tcp:127.0.0.1:8101";  // or a serial device such as "/dev/ttyUSB0"
  bool enable_motors_at_start = true;         // enable_motors = "at_start" | "on_request"
  double command_timeout = 0.3;               // [s] age at which a VELOCITY_COMMAND no longer moves the robot
  double supervised = 0.0;                    // [s] without a living page or operator, then it stands; 0 = never
  double guardian_silence = 0.3;              // [s] without a sign of life, then the guardian acts
  double guardian_done_after = 0.0;           // [s] of silence, then the guardian has left the line; 0 = there is none
  std::filesystem::path state_folder;         // where the software stop survives a restart; "" = it does not
  RobotDescription robot;
};

/// Refuses what the ranges of single keys do not; `table` is the driver's, `baud` [bit/s]. Throws ConfigurationError.
void check_base_config(const TomlTable& table, const BaseConfig& config, int baud);

}  // namespace luminav
