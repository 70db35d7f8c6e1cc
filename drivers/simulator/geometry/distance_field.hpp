#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// Distance from each cell of a map to the nearest cell that is solid, centre to centre less half a cell.
class DistanceField {
 public:
  /// No map, nothing solid anywhere.
  DistanceField() = default;
  /// `is_solid` has one entry per cell of the geometry; `beyond` says whether all outside the grid is solid, too.
  DistanceField(const GridGeometry& geometry, const std::vector<bool>& is_solid, bool beyond);

  /// [m], 0 in and at a solid cell, `kFar` where nothing solid is known; within half a diagonal of a cell of the truth.
  [[nodiscard]] double at(const Eigen::Vector2d& point_in_world) const {
    const Cell cell = geometry_.cell_at(point_in_world);
    return geometry_.contains(cell) ? distances_[geometry_.index(cell)] : beyond_;
  }
  [[nodiscard]] double at(const Cell& cell) const { return distances_[geometry_.index(cell)]; }
  [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }

  static constexpr double kFar = 1e3;  // [m]

 private:
  GridGeometry geometry_;
  std::vector<float> distances_;  // [m]
  double beyond_ = kFar;          // [m] outside the grid
};

/// Solid = occupied: what a robot hits and a sonar hears.
DistanceField distance_to_walls(const PriorMap& map);
/// Solid = everything that is not known to be free, outside included: where nothing is placed.
DistanceField distance_to_not_free(const PriorMap& map);

}  // namespace luminav
