#include "services/surveyor/known_building.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/configuration_error.hpp"

namespace luminav {
namespace {

constexpr double kSameHeight = 0.05;                       // [m] between what two files say of the ceiling
constexpr KnownAccuracy kTapeMeasure{0.02, radians(1.0)};  // of a file that does not say

/// The kind of a fixture, which is added where none is alike.
int kind_among(CeilingKinds& kinds, const Fixture& fixture) {
  const auto found = std::find_if(kinds.kinds.begin(), kinds.kinds.end(),
                                  [&](const Fixture& kind) { return looks_alike(kind, fixture); });
  const auto index = static_cast<int>(found - kinds.kinds.begin());
  if (found == kinds.kinds.end()) {
    kinds.kinds.push_back(fixture);
    kinds.kinds.back().id = index + 1;
  }
  return index;
}

}  // namespace

KnownBuilding read_known_building(const std::filesystem::path& file, CeilingKinds& kinds) {
  KnownBuilding known;
  known.file = std::filesystem::is_directory(file) ? file / "building.toml" : file;
  known.building = read_building(known.file);
  if (known.building.fixtures.empty()) {
    throw ConfigurationError(
        fmt::format("{}: has no [[fixture]]: nothing tells where the drive lies in it", known.file.string()));
  }
  if (kinds.kinds.empty()) {
    kinds.ceiling_height = known.building.ceiling_height;
  }
  if (std::abs(kinds.ceiling_height - known.building.ceiling_height) > kSameHeight) {
    throw ConfigurationError(fmt::format("{}: ceiling_height = {:.2f}, and {:.2f} m in the file of kinds: which is it?",
                                         known.file.string(), known.building.ceiling_height, kinds.ceiling_height));
  }
  for (const Fixture& fixture : known.building.fixtures) {
    known.kinds.push_back(kind_among(kinds, fixture));
  }
  if (!known.building.map_file.empty()) {
    known.map = read_map(known.building.map_file);
  }
  return known;
}

KnownAccuracy accuracy_of(const Building& building, int count) {
  if (!building.survey) {
    return kTapeMeasure;
  }
  const double share = std::sqrt(static_cast<double>(std::max(1, count)));
  return {share * building.survey->position, share * building.survey->heading};
}

}  // namespace luminav
