#pragma once

#include <filesystem>
#include <vector>

namespace luminav {

/// Writes three buildings drawn by hand that differ in kind from the generated worlds, each as a folder with building,
/// map and scenario (an unknown start and three goals): an old house with one odd lamp a room, a hospital ward with
/// round lamps in the corridor and square panels in like rooms, and a hotel with nothing but round downlights. Returns
/// the scenarios in this order; same files each time.
std::vector<std::filesystem::path> make_drawn_buildings(const std::filesystem::path& folder);

/// The scenarios of mishaps, in the drawn buildings and the laboratory: fixtures that hang elsewhere than the file
/// says, wheels that slip, a robot that is bumped. Likewise.
std::vector<std::filesystem::path> make_mishaps(const std::filesystem::path& folder);

}  // namespace luminav
