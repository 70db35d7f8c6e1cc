#pragma once

#include <string>

#include "drivers/camera/calibration/chessboard_calibration.hpp"

namespace luminav {

/// The text of a robot's file with the lens in its camera table; mounting and timing stay as they are.
std::string with_lens(const std::string& robot_toml, const LensCalibration& calibration);

}  // namespace luminav
