#include "drivers/simulator/world/luminaire_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "drivers/simulator/geometry/random_stream.hpp"
#include "services/common/building/building.hpp"

namespace luminav {
namespace {

constexpr double kHangsLower = 0.1;  // [m] below the ceiling: then on ropes

}  // namespace

const std::vector<std::string>& luminaire_names() {
  static const std::vector<std::string> names{"panel",     "louvre",  "batten",    "opal",    "opal-framed",
                                              "prismatic", "pendant", "downlight", "high-bay"};
  return names;
}

std::optional<LuminaireKind> luminaire_named(const std::string& name) {
  const auto& names = luminaire_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    return std::nullopt;
  }
  return static_cast<LuminaireKind>(found - names.begin());
}

bool is_built_as(LuminaireKind kind, const Fixture& fixture, double ceiling_height) {
  const bool round = fixture.shape == FixtureShape::kRound;
  switch (kind) {
    case LuminaireKind::kPanel:
      return true;
    case LuminaireKind::kLouvre:  // each tube has a trough of 0.1 m or more
      return !round && fixture.width >= 0.1 * std::max(1, fixture.lamps) && fixture.width >= 0.12;
    case LuminaireKind::kBatten:
      return !round && fixture.width <= 0.2 && fixture.lamps <= 2;
    case LuminaireKind::kOpal:
    case LuminaireKind::kOpalFramed:
    case LuminaireKind::kPrismatic:
      return !round && fixture.width >= 0.12;
    case LuminaireKind::kPendant:
      return !round && fixture.width <= 0.3 && fixture.height < ceiling_height - kHangsLower;
    case LuminaireKind::kDownlight:
      return round && fixture.length <= 0.35;
    case LuminaireKind::kHighBay:
      return round && fixture.length >= 0.3;
  }
  return false;
}

std::vector<LuminaireKind> draw_luminaires(const std::vector<LuminaireKind>& choice, const Building& building,
                                           std::uint64_t seed) {
  std::vector<LuminaireKind> kinds;
  kinds.reserve(building.fixtures.size());
  for (const Fixture& fixture : building.fixtures) {
    std::vector<LuminaireKind> fitting;
    std::copy_if(choice.begin(), choice.end(), std::back_inserter(fitting),
                 [&](LuminaireKind kind) { return is_built_as(kind, fixture, building.ceiling_height); });
    if (fitting.empty()) {
      kinds.push_back(LuminaireKind::kPanel);
      continue;
    }
    const std::string like =
        fmt::format("luminaire {} {:.3f} {:.3f} {} {}", static_cast<int>(fixture.shape), fixture.length, fixture.width,
                    fixture.lamps, fixture.height < building.ceiling_height - kHangsLower);
    RandomStream random(seed, like);
    kinds.push_back(fitting[random.below(fitting.size())]);
  }
  return kinds;
}

}  // namespace luminav
