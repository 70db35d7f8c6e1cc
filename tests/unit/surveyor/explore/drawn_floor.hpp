#pragma once

#include <string>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// A grid of 0.1 m drawn as text, the uppermost row first: '#' occupied, '+' occupied by few echoes, '.' known as free,
/// anything else unknown. Each letter is a square of 2 x 2 cells.
inline OccupancyGrid drawn_floor(const std::vector<std::string>& rows) {
  GridGeometry geometry;
  geometry.columns = 2 * static_cast<int>(rows.front().size());
  geometry.rows = 2 * static_cast<int>(rows.size());
  OccupancyGrid grid(geometry);
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      const char letter =
          rows[rows.size() - 1 - static_cast<std::size_t>(row / 2)][static_cast<std::size_t>(column / 2)];
      grid.evidence[geometry.index({column, row})] = letter == '#' ? 60 : letter == '+' ? 24 : letter == '.' ? -20 : 0;
    }
  }
  return grid;
}

}  // namespace luminav
