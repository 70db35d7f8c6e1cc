#pragma once

#include <string>

#include "services/common/building/building.hpp"
#include "services/common/building/map_file.hpp"
#include "tests/replay/replay_run.hpp"

namespace luminav {

/// Draws a replay over the building's map as a PNG: the truth grey and wide, the recorded poses black, the replayed
/// ones green (particle filter and hypotheses) and blue (Kalman filter), odometry magenta, put onto the first replayed
/// pose while TRACKING; the sonar's evidence light green. Throws std::runtime_error when it cannot be written.
void draw_replay(const std::string& png_file, const PriorMap& walls, const Building& building,
                 const ReplayReport& report);

}  // namespace luminav
