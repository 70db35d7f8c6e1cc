#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/planner/path/path_shaping.hpp"
#include "services/planner/space/configuration_space.hpp"

namespace luminav {

/// A place [m, world] lies in the opening of a door: nobody can pass.
bool is_in_opening(const Door& door, const Eigen::Vector2d& place);

/// Whoever comes through the door while the robot is at a place [m, world] finds it in his way.
bool is_in_doorway(const Door& door, const Eigen::Vector2d& place);

/// Places [m, world] beside the way through a door, on the side from which `path` comes to it, where the robot can turn
/// and the door is near and in sight; the nearest to the way's start first. Empty where there is no room.
std::vector<Eigen::Vector2d> places_beside(const Door& door, const Polyline& path, const ConfigurationSpace& space);

}  // namespace luminav
