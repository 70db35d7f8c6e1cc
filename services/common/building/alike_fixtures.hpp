#pragma once

#include <cstddef>
#include <vector>

#include "services/common/building/building.hpp"

namespace luminav {

/// How far around a fixture its surroundings count [m]: what a camera under it sees, and a step to each side.
inline constexpr double kSurroundings = 4.0;

/// Fixtures that cannot be told from another one by what hangs around them.
struct AlikeFixtures {
  std::size_t fixtures = 0;                // how many have a double
  std::vector<std::size_t> largest_group;  // indices; each looks like the first
  std::size_t without_heading = 0;         // round ones with nothing but round things within kSurroundings
};

/// Two fixtures are alike when a motion that brings one onto the other (a rectangle has two such motions, a square
/// four; one of a round fixture lays its nearest neighbour on a like one) brings all fixtures and elements within
/// kSurroundings onto ones of equal kind and size, within 0.15 m and 8 degrees. Walls are not looked at, so this errs
/// on the side of "alike".
AlikeFixtures find_alike_fixtures(const Building& building);

}  // namespace luminav
