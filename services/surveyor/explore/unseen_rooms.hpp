#pragma once

#include <cstdint>
#include <vector>

#include "services/planner/space/configuration_space.hpp"

namespace luminav {

/// Marks the cells of unknown floor that may be a room: it has room for the robot in `space`, hangs together over at
/// least `min_area` [m^2], and lies inside the convex outline of what was `reached`, a flag per cell.
std::vector<std::uint8_t> find_unseen_rooms(const ConfigurationSpace& space, const std::vector<std::uint8_t>& reached,
                                            double min_area);

}  // namespace luminav
