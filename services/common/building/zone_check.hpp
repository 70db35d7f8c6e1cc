#pragma once

#include <vector>

#include "services/common/building/building_check.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/common/configuration/building_file.hpp"

namespace luminav {

/// What is wrong with a building's zones: two of one name, two that overlap and contradict each other, one outside the
/// map, keep-out zones that cut the floor in two and one-way zones that lead only out of a part of it or only into it,
/// with the floor, the places and the doors that are lost. All zones count as in force, whatever
/// their hours. `map` may be null.
std::vector<BuildingFinding> check_zones(const BuildingSource& source, const PriorMap* map);

}  // namespace luminav
