#pragma once

#include <cstdint>
#include <vector>

#include "services/planner/space/bit_grid.hpp"

namespace luminav {

/// Farthest distance [cells] that a distance field tells; its square fits into a byte.
inline constexpr int kDistanceReach = 15;
/// Squared distance [cells^2] where nothing is near.
inline constexpr std::uint8_t kNothingNear = 255;

/// Squares of the exact Euclidean distances [cells^2], centre to centre, from each cell to the nearest one that is set
/// in `solid`; kNothingNear beyond kDistanceReach. Two passes over the grid with bounded reach, about 2 ns a cell.
std::vector<std::uint8_t> squared_distances(const BitGrid& solid);

/// Writes the squared distances of a window of the grid only; `result` has a value for every cell of the grid,
/// row-major. Right when `solid` changed nowhere farther than kDistanceReach inside the window's border.
void update_squared_distances(const BitGrid& solid, const CellWindow& window, std::uint8_t* result);

}  // namespace luminav
