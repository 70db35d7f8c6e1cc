#pragma once

#include <string>

#include "services/planner/goals/goal_types.hpp"
#include "services/planner/path/route_planner.hpp"

namespace luminav {

/// "kitchen (4.2, 3.1)", or the numbers alone.
std::string place_of(const GoalStop& stop);

/// Why no path leads to a stop, with the nearest point that can be reached; `tolerance` [m] is what the plan was
/// allowed.
std::string no_path_sentence(const Route& route, const GridGeometry& geometry, const GoalStop& stop, double tolerance);

/// Where the robot came to a stop instead of in the tolerance [m] of the goal.
std::string missed_sentence(const Pose2& world_from_robot, const GoalStop& stop, double tolerance);

/// Why the robot makes no progress, in the controller's words.
std::string what_controller_says(const Situation& situation);

}  // namespace luminav
