#pragma once

#include <filesystem>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// Keeps the evidence layer for the next start: geometry, then the compressed cells; written to a temporary file and
/// renamed. Throws std::runtime_error when it cannot be written.
void write_evidence(const std::filesystem::path& file, const OccupancyGrid& grid);

/// Reads what write_evidence wrote into a grid of the same geometry; false, and the grid unchanged, when the file is
/// missing, cut, or of another map.
[[nodiscard]] bool read_evidence(const std::filesystem::path& file, OccupancyGrid& grid);

}  // namespace luminav
