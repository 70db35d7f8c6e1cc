#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// The building's walls as a field of distances at 0.1 m: how far is the nearest wall, and is this place free? Without
/// a map everything is free and no wall is near.
class WallField {
 public:
  WallField() = default;
  explicit WallField(const PriorMap& map);

  [[nodiscard]] bool has_walls() const { return !distance_.empty(); }
  /// [m] to the nearest occupied cell, 0 inside one, at most kFarthest; bilinear between cell centres. Outside the map
  /// kFarthest.
  [[nodiscard]] double distance_to_wall(const Eigen::Vector2d& point_in_world) const;
  /// Free in the building's map; without a map always.
  [[nodiscard]] bool is_free(const Eigen::Vector2d& point_in_world) const;
  /// Way [m] from a point along a direction to the first occupied cell, at most `limit`.
  [[nodiscard]] double range_to_wall(const Eigen::Vector2d& from, const Eigen::Vector2d& direction, double limit) const;
  /// The map at 0.1 m.
  [[nodiscard]] const PriorMap& map() const { return map_; }

  static constexpr double kFarthest = 2.5;    // [m]
  static constexpr double kResolution = 0.1;  // [m]

 private:
  PriorMap map_;
  std::vector<std::uint8_t> distance_;  // [cm] to the nearest occupied cell's centre, row-major from the lower left
};

}  // namespace luminav
