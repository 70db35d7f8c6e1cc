#pragma once

#include <filesystem>

#include "drivers/base/base_config.hpp"

namespace luminav {

/// Table [create2] of the robot's file, and what the driver needs of the rest of it.
struct Create2Config : BaseConfig {
  int baud = 115200;  // [bit/s] of a serial device; an older Roomba may be set to 19200
};

/// Throws ConfigurationError.
Create2Config read_create2_config(const std::filesystem::path& robot_file);

}  // namespace luminav
