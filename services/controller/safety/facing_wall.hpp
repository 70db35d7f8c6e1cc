#pragma once

#include <optional>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// Distance [m] to a wall of the building's map that faces a sonar disc, all of its cone at about a right angle, no
/// farther than `farthest` [m]: such a wall echoes surely. Nothing where there is none, or where the map is unknown or
/// disputed in between. `half_angle` [rad] of the cone.
std::optional<double> facing_wall(const OccupancyGrid& grid, const Pose2& world_from_sonar, double half_angle,
                                  double farthest);

}  // namespace luminav
