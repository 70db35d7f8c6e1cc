#pragma once

#include <string>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// A grid drawn as text, the top line farthest north: # occupied, . free, ? unknown, ~ disputed, o evidence of
/// something.
inline OccupancyGrid floor_plan(const std::vector<std::string>& lines, double resolution = 0.1) {
  OccupancyGrid grid({resolution, {0.0, 0.0}, static_cast<int>(lines.front().size()), static_cast<int>(lines.size())});
  for (int row = 0; row < grid.geometry.rows; ++row) {
    const std::string& line = lines[lines.size() - 1 - static_cast<std::size_t>(row)];
    for (int column = 0; column < grid.geometry.columns; ++column) {
      const std::size_t i = grid.geometry.index({column, row});
      switch (line[static_cast<std::size_t>(column)]) {
        case '#':
          grid.prior[i] = Prior::kOccupied;
          break;
        case '?':
          grid.prior[i] = Prior::kUnknown;
          break;
        case '~':
          grid.prior[i] = Prior::kDisputed;
          break;
        case 'o':
          grid.prior[i] = Prior::kFree;
          grid.evidence[i] = 50;
          break;
        default:
          grid.prior[i] = Prior::kFree;
      }
    }
  }
  return grid;
}

/// An empty room of width x height [m] inside walls of 0.2 m.
inline OccupancyGrid empty_room(double width, double height) {
  OccupancyGrid grid({0.1, {0.0, 0.0}, static_cast<int>(width * 10.0 + 4.5), static_cast<int>(height * 10.0 + 4.5)});
  for (int row = 0; row < grid.geometry.rows; ++row) {
    for (int column = 0; column < grid.geometry.columns; ++column) {
      const bool inside = row >= 2 && column >= 2 && row < grid.geometry.rows - 2 && column < grid.geometry.columns - 2;
      grid.prior[grid.geometry.index({column, row})] = inside ? Prior::kFree : Prior::kOccupied;
    }
  }
  return grid;
}

inline void build_wall(OccupancyGrid& grid, double x, double y, double to_x, double to_y,
                       Prior value = Prior::kOccupied) {
  for (int row = 0; row < grid.geometry.rows; ++row) {
    for (int column = 0; column < grid.geometry.columns; ++column) {
      const Eigen::Vector2d p = grid.geometry.centre_of({column, row});
      if (p.x() > x && p.x() < to_x && p.y() > y && p.y() < to_y) {
        grid.prior[grid.geometry.index({column, row})] = value;
      }
    }
  }
}

}  // namespace luminav
