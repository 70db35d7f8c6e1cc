#pragma once

#include <filesystem>
#include <vector>

namespace luminav {

/// Writes eight buildings drawn by hand that differ in kind from the generated worlds, each as a folder with building,
/// map and scenario (an unknown start and three goals): an old house with one odd lamp a room, a hospital ward with
/// round lamps in the corridor and square panels in like rooms, a hotel with nothing but round downlights, an open-plan
/// office, a school whose hall has a higher ceiling, a long corridor of equal lamps with one odd end, ten equal rooms,
/// and a museum. Returns the scenarios in this order; same files each time.
std::vector<std::filesystem::path> make_drawn_buildings(const std::filesystem::path& folder);

}  // namespace luminav
