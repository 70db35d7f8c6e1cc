#pragma once

#include <cstdint>
#include <vector>

namespace luminav {

/// Farthest distance [cells] that a distance field tells; its square fits into a byte.
inline constexpr int kDistanceReach = 15;
/// Squared distance [cells^2] where nothing is near.
inline constexpr std::uint8_t kNothingNear = 255;

/// Squares of the exact Euclidean distances [cells^2], centre to centre, from each cell to the nearest one that is set
/// in `solid` (row-major, non-zero = set); kNothingNear beyond kDistanceReach. Two passes over the grid with bounded
/// reach, about 2 ns a cell.
void squared_distances(const std::vector<std::uint8_t>& solid, int columns, int rows,
                       std::vector<std::uint8_t>& result);

/// The same for a window of the grid only, columns and rows [first, last); right when `solid` changed nowhere farther
/// than kDistanceReach inside the window's border.
void update_squared_distances(const std::vector<std::uint8_t>& solid, int columns, int rows, int first_column,
                              int last_column, int first_row, int last_row, std::vector<std::uint8_t>& result);

}  // namespace luminav
