#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// A building as a plan on paper: walls, fixtures with their ids, vents and detectors, windows, doors, places, a scale
/// bar. Fixtures whose ids are in `marked` are red. Standalone SVG text; `map` may be null.
std::string draw_building_svg(const Building& building, const PriorMap* map, const std::vector<int>& marked);

/// The same as a PNG, at most 1,600 pixels wide. Throws std::runtime_error when it cannot be written.
void draw_building_png(const std::filesystem::path& file, const Building& building, const PriorMap* map,
                       const std::vector<int>& marked);

}  // namespace luminav
