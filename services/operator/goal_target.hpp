#pragma once

#include <luminav/goal_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"

namespace luminav {

/// The words as numbers; nothing unless all of them are finite numbers.
std::optional<std::vector<double>> read_numbers(const std::vector<std::string>& words);

/// X, Y [m] and perhaps a heading [rad] that was typed in radians or, as 90deg, in degrees; nothing for a place's name.
std::optional<std::vector<double>> read_point(std::vector<std::string> words);

/// A goal from what a person typed: X Y, X Y THETA, X Y 90deg, or the name of a place. Throws ConfigurationError naming
/// the known places.
goal_t make_goal(const std::vector<std::string>& words, const Building& building);

/// The launched building, LUMINAV_BUILDING or that of LUMINAV_SCENARIO; else the laboratory that comes with the project
/// or was installed with it, found from the program's own place; "" when it is not there. Throws ConfigurationError for
/// a scenario that names none.
std::string default_building_file();

}  // namespace luminav
