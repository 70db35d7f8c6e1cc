#pragma once

#include <filesystem>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// Reads a map in the ROS map_server format (YAML beside a PGM or PNG; modes trinary, scale and raw, negate, an origin
/// with a yaw). A turned map becomes one along the axes of the world, with what lies outside it unknown. Throws
/// ConfigurationError naming the file and what is wrong (missing, cut, another format, out of range).
PriorMap read_map(const std::filesystem::path& yaml_file);

/// Writes YAML and PGM beside it, each to a temporary file that is then renamed. Occupied 0, free 254, unknown 205;
/// a disputed cell is written as occupied. Throws std::runtime_error when the folder cannot be written.
void write_map(const std::filesystem::path& yaml_file, const PriorMap& map);

}  // namespace luminav
