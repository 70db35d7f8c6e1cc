#include "services/common/building/occupancy_grid.hpp"

#include <algorithm>

namespace luminav {

PriorMap resample(const PriorMap& map, double resolution) {
  if (std::abs(map.geometry.resolution - resolution) < 1e-9) {
    return map;
  }
  const double ratio = map.geometry.resolution / resolution;
  PriorMap result;
  result.geometry.resolution = resolution;
  result.geometry.origin = map.geometry.origin;
  result.geometry.columns = static_cast<int>(std::ceil(map.geometry.columns * ratio - 1e-9));
  result.geometry.rows = static_cast<int>(std::ceil(map.geometry.rows * ratio - 1e-9));
  result.cells.assign(result.geometry.size(), Prior::kUnknown);
  const double inverse = 1.0 / ratio;
  for (int row = 0; row < result.geometry.rows; ++row) {
    const int first_row = static_cast<int>(std::floor(row * inverse + 1e-9));
    const int last_row = std::min(map.geometry.rows - 1, static_cast<int>(std::ceil((row + 1) * inverse - 1e-9)) - 1);
    for (int column = 0; column < result.geometry.columns; ++column) {
      const int first_column = static_cast<int>(std::floor(column * inverse + 1e-9));
      const int last_column =
          std::min(map.geometry.columns - 1, static_cast<int>(std::ceil((column + 1) * inverse - 1e-9)) - 1);
      bool all_free = true;
      bool any_occupied = false;
      for (int r = first_row; r <= last_row; ++r) {
        for (int c = first_column; c <= last_column; ++c) {
          const Prior cell = map.cells[map.geometry.index({c, r})];
          any_occupied = any_occupied || cell == Prior::kOccupied;
          all_free = all_free && cell == Prior::kFree;
        }
      }
      Prior& target = result.cells[result.geometry.index({column, row})];
      target = any_occupied ? Prior::kOccupied : (all_free ? Prior::kFree : Prior::kUnknown);
    }
  }
  return result;
}

OccupancyGrid::OccupancyGrid(const GridGeometry& size)
    : geometry(size), prior(size.size(), Prior::kUnknown), evidence(size.size(), 0) {}

}  // namespace luminav
