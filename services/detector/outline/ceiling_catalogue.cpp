#include "services/detector/outline/ceiling_catalogue.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kSameSide = 0.005;   // [m]
constexpr double kSameHeight = 0.02;  // [m]

void add_once(std::vector<CeilingKind>& kinds, const CeilingKind& kind) {
  const auto same = [&](const CeilingKind& other) {
    return other.shape == kind.shape && other.lamps == kind.lamps && other.slatted == kind.slatted &&
           std::abs(other.length - kind.length) < kSameSide && std::abs(other.width - kind.width) < kSameSide &&
           std::abs(other.height - kind.height) < kSameHeight;
  };
  const auto known = std::find_if(kinds.begin(), kinds.end(), same);
  if (known == kinds.end()) {
    kinds.push_back(kind);
  } else {
    known->count += kind.count;
  }
}

void sort_by_size(std::vector<CeilingKind>& kinds) {
  std::stable_sort(kinds.begin(), kinds.end(),
                   [](const CeilingKind& a, const CeilingKind& b) { return a.length * a.width > b.length * b.width; });
}

}  // namespace

CeilingCatalogue catalogue_of(const Building& building) {
  CeilingCatalogue catalogue;
  catalogue.ceiling_height = building.ceiling_height;
  for (const Fixture& fixture : building.fixtures) {
    add_once(catalogue.fixtures, {.shape = fixture.shape,
                                  .length = std::max(fixture.length, fixture.width),
                                  .width = std::min(fixture.length, fixture.width),
                                  .height = fixture.height,
                                  .lamps = fixture.lamps});
  }
  for (const CeilingElement& element : building.elements) {
    const double length = std::max(element.length, element.width);
    const double width = std::min(element.length, element.width);
    const bool round = element.kind == ElementKind::kDetector || element.kind == ElementKind::kSpeaker;
    const bool square = length - width < kSameSide;
    add_once(catalogue.elements, {.shape = round    ? FixtureShape::kRound
                                           : square ? FixtureShape::kSquare
                                                    : FixtureShape::kRectangle,
                                  .length = length,
                                  .width = width,
                                  .height = building.ceiling_height,
                                  .lamps = 0,
                                  .luminous = element.kind == ElementKind::kSign,
                                  .slatted = element.kind == ElementKind::kVent});
  }
  sort_by_size(catalogue.fixtures);
  sort_by_size(catalogue.elements);
  return catalogue;
}

}  // namespace luminav
