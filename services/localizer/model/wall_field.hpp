#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/ceiling/fixture_map.hpp"

namespace luminav {

/// The building's walls as a field of distances at 0.1 m: how far is the nearest wall, and is this place free? Without
/// a map everything is free and no wall is near.
class WallField {
 public:
  WallField() = default;
  explicit WallField(const PriorMap& map, bool is_complete = true);

  [[nodiscard]] bool has_walls() const { return !tiles_.empty(); }
  /// [m] to the nearest occupied cell, 0 inside one, at most kFarthest; bilinear between cell centres. Outside the map
  /// kFarthest.
  [[nodiscard]] double distance_to_wall(const Eigen::Vector2d& point_in_world) const;
  /// Free in the building's map; without a map always.
  [[nodiscard]] bool is_free(const Eigen::Vector2d& point_in_world) const;
  /// Unknown in a map that need not show all walls.
  [[nodiscard]] bool may_hide_wall(const Eigen::Vector2d& point_in_world) const {
    return !is_complete_ && map_.at(point_in_world) == Prior::kUnknown;
  }
  /// Way [m] from a point along a direction to the first occupied cell, at most `limit`.
  [[nodiscard]] double range_to_wall(const Eigen::Vector2d& from, const Eigen::Vector2d& direction, double limit) const;
  /// The map at 0.1 m.
  [[nodiscard]] const PriorMap& map() const { return map_; }

  static constexpr double kFarthest = 2.5;    // [m]
  static constexpr double kResolution = 0.1;  // [m]

 private:
  static constexpr std::size_t kTile = 8;  // cells on a side: a line of the cache, whatever direction a ray has
  [[nodiscard]] std::size_t tiled(std::size_t column, std::size_t row) const {
    return ((row / kTile * tile_columns_ + column / kTile) * kTile + row % kTile) * kTile + column % kTile;
  }

  PriorMap map_;
  bool is_complete_ = true;
  std::vector<std::uint8_t> tiles_;  // [cm] to the nearest occupied cell's centre, row-major in tiles and of tiles
  std::size_t tile_columns_ = 0;
};

/// Where a robot may be [m]: the extent of the map; without one, of the fixtures and 2 m around.
[[nodiscard]] Eigen::AlignedBox2d extent_of_floor(const PriorMap& map, const FixtureMap& fixtures);

}  // namespace luminav
