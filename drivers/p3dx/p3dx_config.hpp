#pragma once

#include <filesystem>

#include "drivers/base/base_config.hpp"

namespace luminav {

/// Table [p3dx] of the robot's file, and what the driver needs of the rest of it.
struct P3dxConfig : BaseConfig {
  int baud = 9600;                       // [bit/s] of a serial device when the robot is switched on
  int fast_baud = 0;                     // [bit/s] to switch a serial line to once connected; 0 = stay
  bool assume_p3dx_sh = false;           // drive a robot of unknown subclass as a p3dx-sh
  double angular_deceleration = 2.0944;  // [rad/s^2] of the turn when stopping
  double distance_factor = 0.0;          // [mm per unit] of the robot's x, y; 0 = by its subclass
};

/// Throws ConfigurationError.
P3dxConfig read_p3dx_config(const std::filesystem::path& robot_file);

}  // namespace luminav
