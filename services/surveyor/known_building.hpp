#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/surveyor/survey/ceiling_kinds.hpp"

namespace luminav {

/// A building that has a file already: a survey that begins with it keeps its frame, its names and all that the robot
/// does not pass.
struct KnownBuilding {
  std::filesystem::path file;
  Building building;
  std::optional<PriorMap> map;
  std::vector<int> kinds;  // of each of its fixtures, index into the survey's kinds
};

/// Reads a building.toml, or that of a folder, with its map. Its fixtures are of the kinds that they resemble; kinds
/// that are missing among `kinds` are added. Throws ConfigurationError, also where the two disagree on the ceiling.
KnownBuilding read_known_building(const std::filesystem::path& file, CeilingKinds& kinds);

/// How far fixtures of the file may be off, 1-sigma. What a surveyed file says of itself is an error that all of its
/// fixtures share, which does not average away: each of `count` gets its part of the variance of the mean.
struct KnownAccuracy {
  double position = 0.0;  // [m]
  double heading = 0.0;   // [rad]
};
KnownAccuracy accuracy_of(const Building& building, int count);

}  // namespace luminav
