#pragma once

#include "services/common/configuration/toml_table.hpp"
#include "services/localizer/model/error_model.hpp"
#include "services/localizer/model/wheel_correction.hpp"

namespace luminav {

/// What a robot's file says of its own errors.
struct RobotErrors {
  ErrorParams errors;
  WheelCorrection wheels;  // from a calibration drive
};

/// Reads [localizer.errors] and [localizer.wheels]; `table` is [localizer]. Throws ConfigurationError.
RobotErrors read_robot_errors(const TomlTable& table);

}  // namespace luminav
