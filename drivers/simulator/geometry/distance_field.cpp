#include "drivers/simulator/geometry/distance_field.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/building/distance_transform.hpp"

namespace luminav {

DistanceField::DistanceField(const GridGeometry& geometry, const std::vector<bool>& is_solid, bool beyond)
    : geometry_(geometry), beyond_(beyond ? 0.0 : kFar) {
  // A frame of one cell round the grid stands for what is outside.
  const auto columns = static_cast<std::size_t>(geometry.columns);
  const auto rows = static_cast<std::size_t>(geometry.rows);
  std::vector<bool> framed((columns + 2) * (rows + 2), beyond);
  const auto in_frame = [&](std::size_t column, std::size_t row) { return (row + 1) * (columns + 2) + column + 1; };
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      framed[in_frame(column, row)] = is_solid[row * columns + column];
    }
  }
  const std::vector<float> squared = squared_distances_to(framed, columns + 2);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const double cells = std::sqrt(static_cast<double>(squared[in_frame(column, row)]));
      distances_.push_back(static_cast<float>(std::clamp((cells - 0.5) * geometry.resolution, 0.0, kFar)));
    }
  }
}

DistanceField distance_to_walls(const PriorMap& map) {
  std::vector<bool> solid(map.cells.size());
  std::transform(map.cells.begin(), map.cells.end(), solid.begin(),
                 [](Prior cell) { return cell == Prior::kOccupied; });
  return {map.geometry, solid, false};
}

DistanceField distance_to_not_free(const PriorMap& map) {
  std::vector<bool> solid(map.cells.size());
  std::transform(map.cells.begin(), map.cells.end(), solid.begin(), [](Prior cell) { return cell != Prior::kFree; });
  return {map.geometry, solid, true};
}

}  // namespace luminav
