#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"

namespace luminav {

/// Reads a building.toml strictly. Throws ConfigurationError, naming file, line, key and what is allowed; two fixtures
/// with one id are an error, and so is a zone whose edges cross.
Building read_building(const std::filesystem::path& file);

/// A building and the line of its file on which each table begins, in the building's order.
struct BuildingSource {
  Building building;
  std::vector<int> fixture_lines;
  std::vector<int> door_lines;
  std::vector<int> place_lines;
  std::vector<int> zone_lines;
};
/// As read_building.
BuildingSource read_building_source(const std::filesystem::path& file);

/// The corners as a TOML array of arrays, to the millimetre.
std::string polygon_text(const Polygon& polygon);

/// The text of a [[fixture]] table, as write_building has it.
std::string fixture_table(const Fixture& fixture, double ceiling_height);

/// Writes a building.toml to a temporary file that is then renamed; `building.map_file` is written as given. Throws
/// std::runtime_error when the folder cannot be written.
void write_building(const std::filesystem::path& file, const Building& building);

}  // namespace luminav
