#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// Table [p3dx] of the robot's file, and what the driver needs of the rest of it.
struct P3dxConfig {
  std::string device = "tcp:127.0.0.1:8101";  // or a serial device such as "/dev/ttyUSB0"
  int baud = 9600;                            // [bit/s] of a serial device when the robot is switched on
  int fast_baud = 0;                          // [bit/s] to switch a serial line to once connected; 0 = stay
  bool enable_motors_at_start = true;         // enable_motors = "at_start" | "on_request"
  bool assume_p3dx_sh = false;                // drive a robot of unknown subclass as a p3dx-sh
  double command_timeout = 0.3;               // [s] age at which a VELOCITY_COMMAND no longer moves the robot
  double angular_deceleration = 2.0944;       // [rad/s^2] of the turn when stopping
  double distance_factor = 0.0;               // [mm per unit] of the robot's x, y; 0 = by its subclass
  double supervised = 0.0;                    // [s] without a living page or operator, then it stands; 0 = never
  double guardian_silence = 0.3;              // [s] without a sign of life, then the guardian acts
  double guardian_done_after = 0.0;    // [s] of silence, then the guardian has ended the session; 0 = there is none
  std::filesystem::path state_folder;  // where the software stop survives a restart; "" = it does not
  RobotDescription robot;
};

/// Throws ConfigurationError.
P3dxConfig read_p3dx_config(const std::filesystem::path& robot_file);

}  // namespace luminav
