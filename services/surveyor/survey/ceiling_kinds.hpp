#pragma once

#include <filesystem>
#include <vector>

#include "services/common/building/building.hpp"

namespace luminav {

/// What one person measures before a survey: how high the ceiling is and what hangs there.
struct CeilingKinds {
  double ceiling_height = 2.8;  // [m]
  std::vector<Fixture> kinds;   // shape, size, height and lamps count; ids run from 1, poses say nothing
};

/// Reads a file of kinds strictly: `ceiling_height` and [[kind]] with `shape`, `length`, `width` (or `diameter`),
/// `lamps` and `height`, as a building's [[fixture]] has them. Throws ConfigurationError, also where there is no kind
/// or two of them look the same.
CeilingKinds read_ceiling_kinds(const std::filesystem::path& file);

/// Whether two fixtures are of one kind to the camera: their sides differ by less than 3 cm.
bool looks_alike(const Fixture& a, const Fixture& b);

/// A building with one fixture of each kind, for what needs to know the kinds only.
Building building_of(const CeilingKinds& kinds);

}  // namespace luminav
