#pragma once

#include <string>
#include <vector>

#include "services/common/configuration/building_file.hpp"

namespace luminav {

/// What check-building finds wrong with a building, notes apart, without the lines of the file that it names. Reads the
/// building's map; takes a second for a large one. Throws as read_map does.
std::vector<std::string> findings_of(const BuildingSource& source);

/// Those of them that are not among these.
std::vector<std::string> without(std::vector<std::string> found, const std::vector<std::string>& known);

}  // namespace luminav
