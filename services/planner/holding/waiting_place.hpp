#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/planner/path/path_shaping.hpp"
#include "services/planner/space/configuration_space.hpp"

namespace luminav {

/// True if a place [m, world] lies in the opening of a door: a robot there lets nobody pass.
bool is_in_opening(const Door& door, const Eigen::Vector2d& place);

/// True if a robot at a place [m, world] would obstruct a person who comes through the door.
bool is_in_doorway(const Door& door, const Eigen::Vector2d& place);

/// Places [m, world] beside the passage of a door, on the side from which `path` reaches it, where the robot can turn
/// and the door is near and in sight; the nearest to the passage's start first. Empty where there is no room.
std::vector<Eigen::Vector2d> places_beside(const Door& door, const Polyline& path, const ConfigurationSpace& space);

}  // namespace luminav
