#pragma once

#include <filesystem>
#include <vector>

namespace luminav {

/// Writes the worlds that differ in their ceilings (dense, sparse, square panels, mixed with vents and detectors, high,
/// low) and the corridor that looks the same from both ends, each as a folder with building, map and scenario; returns
/// the scenarios, the laboratory's first. Same files each time.
std::vector<std::filesystem::path> make_worlds(const std::filesystem::path& folder);

/// Floors of about 40, 130, 400, 1,300 and 4,000 fixtures, likewise.
std::vector<std::filesystem::path> make_scale_series(const std::filesystem::path& folder);

}  // namespace luminav
