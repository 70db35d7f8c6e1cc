#pragma once

#include <filesystem>
#include <string>

#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// Table [create2] of the robot's file, and what the driver needs of the rest of it.
struct Create2Config {
  std::string device = "tcp:127.0.0.1:8101";  // or a serial device such as "/dev/ttyUSB0"
  int baud = 115200;                          // [bit/s] of a serial device; an older Roomba may be set to 19200
  bool enable_motors_at_start = true;         // enable_motors = "at_start" | "on_request"
  double command_timeout = 0.3;               // [s] age at which a VELOCITY_COMMAND no longer moves the robot
  double supervised = 0.0;                    // [s] without a living page or operator, then it stands; 0 = never
  double guardian_silence = 0.3;              // [s] without a sign of life, then the guardian acts
  double guardian_done_after = 0.0;           // [s] of silence, then the guardian has left the line; 0 = there is none
  std::filesystem::path state_folder;         // where the software stop survives a restart; "" = it does not
  RobotDescription robot;
};

/// Throws ConfigurationError.
Create2Config read_create2_config(const std::filesystem::path& robot_file);

}  // namespace luminav
