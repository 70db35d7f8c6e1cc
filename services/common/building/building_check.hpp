#pragma once

#include <string>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/configuration/building_file.hpp"

namespace luminav {

enum class FindingKind {
  kError,    // the robot would be misled or the goal cannot be reached
  kWarning,  // looks like a slip of the pen
  kNote      // worth knowing
};

/// Something wrong with a building's file.
struct BuildingFinding {
  FindingKind kind = FindingKind::kError;
  int line = 0;  // of the file
  std::string text;
};

/// What a surveyor would object to: fixtures that overlap, hang in a wall or outside the map, sizes that no shop sells,
/// doors that are walls, places nobody can stand on, that no way leads to or that lie in a keep-out zone, places and
/// doors beside what the map does not know, zones that contradict each other or cut the floor in two, and fixtures that
/// the robot cannot tell apart by their surroundings. All zones count as in force; what only those with hours take away
/// is a warning. `map` may be null (a building without a map). In the order of the file's lines.
std::vector<BuildingFinding> check_building(const BuildingSource& source, const PriorMap* map);

}  // namespace luminav
