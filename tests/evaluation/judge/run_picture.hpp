#pragma once

#include <string>
#include <vector>

#include "drivers/simulator/world/world_truth.hpp"
#include "tests/evaluation/judge/run_judge.hpp"

namespace luminav {

/// Draws a run over the building's map as a PNG: fixtures, boxes, goals, the true way (grey), what the robot believed
/// (particle filter or hypotheses green, Kalman filter blue) and odometry (magenta, put onto the first believed pose).
void draw_run(const std::string& png_file, const WorldTruth& world, const Building& believed,
              const std::vector<TrailPoint>& trail, const std::vector<GoalResult>& goals, const OccupancyGrid* grid);

}  // namespace luminav
