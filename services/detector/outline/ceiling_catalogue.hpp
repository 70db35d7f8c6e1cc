#pragma once

#include <vector>

#include "services/common/building/building.hpp"

namespace luminav {

/// One kind of thing that hangs on the ceiling of a building: fixtures that differ in nothing but place and heading.
struct CeilingKind {
  FixtureShape shape = FixtureShape::kRectangle;
  double length = 1.2;  // [m] long side, or diameter
  double width = 0.3;   // [m] short side, or diameter
  double height = 2.8;  // [m] above the floor
  int lamps = 2;
  bool luminous = true;  // may be brighter than the ceiling
  bool slatted = false;  // striped, as vents are
  int count = 1;         // how many the building has
};

/// What a detector looks for: the kinds of the fixtures and of the other elements of a building, each kind once. An
/// element that is listed keeps the detector from taking it for a part of a fixture.
struct CeilingCatalogue {
  std::vector<CeilingKind> fixtures;
  std::vector<CeilingKind> elements;
  double ceiling_height = 2.8;  // [m] above the floor
};

/// Kinds of a building, the largest first; sides within 5 mm and heights within 20 mm count as the same kind.
CeilingCatalogue catalogue_of(const Building& building);

}  // namespace luminav
