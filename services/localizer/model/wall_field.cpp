#include "services/localizer/model/wall_field.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/building/distance_transform.hpp"

namespace luminav {

WallField::WallField(const PriorMap& map, bool is_complete)
    : map_(resample(map, kResolution)), is_complete_(is_complete) {
  const auto columns = static_cast<std::size_t>(map_.geometry.columns);
  const auto rows = static_cast<std::size_t>(map_.geometry.rows);
  if (columns == 0 || rows == 0) {
    return;
  }
  std::vector<bool> is_wall(map_.cells.size());
  std::transform(map_.cells.begin(), map_.cells.end(), is_wall.begin(),
                 [](Prior cell) { return cell == Prior::kOccupied; });
  const std::vector<float> squared = squared_distances_to(is_wall, columns);
  tile_columns_ = (columns + kTile - 1) / kTile;
  tiles_.assign(tile_columns_ * ((rows + kTile - 1) / kTile) * kTile * kTile, 0);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const double centimetres =
          100.0 * map_.geometry.resolution * std::sqrt(static_cast<double>(squared[row * columns + column]));
      tiles_[tiled(column, row)] = static_cast<std::uint8_t>(std::min(100.0 * kFarthest, centimetres));
    }
  }
}

double WallField::distance_to_wall(const Eigen::Vector2d& point_in_world) const {
  if (!has_walls()) {
    return kFarthest;
  }
  const double column = (point_in_world.x() - map_.geometry.origin.x()) / map_.geometry.resolution - 0.5;
  const double row = (point_in_world.y() - map_.geometry.origin.y()) / map_.geometry.resolution - 0.5;
  if (!(column >= 0.0 && row >= 0.0 && column < map_.geometry.columns - 1 && row < map_.geometry.rows - 1)) {
    return kFarthest;
  }
  const auto c = static_cast<std::size_t>(column);
  const auto r = static_cast<std::size_t>(row);
  const double u = column - static_cast<double>(c);
  const double v = row - static_cast<double>(r);
  const double centimetres = (1.0 - v) * ((1.0 - u) * tiles_[tiled(c, r)] + u * tiles_[tiled(c + 1, r)]) +
                             v * ((1.0 - u) * tiles_[tiled(c, r + 1)] + u * tiles_[tiled(c + 1, r + 1)]);
  return 0.01 * centimetres;
}

bool WallField::is_free(const Eigen::Vector2d& point_in_world) const {
  return !has_walls() || map_.at(point_in_world) == Prior::kFree;
}

double WallField::range_to_wall(const Eigen::Vector2d& from, const Eigen::Vector2d& direction, double limit) const {
  double range = 0.0;
  while (range < limit) {
    const Eigen::Vector2d point = from + range * direction;
    const double near = distance_to_wall(point);
    // distances are to centres of wall cells, whose surface is half a cell nearer
    if (near < 0.6 * map_.geometry.resolution) {
      return range;
    }
    range += std::max(0.5 * map_.geometry.resolution, near - 0.6 * map_.geometry.resolution);
  }
  return limit;
}

Eigen::AlignedBox2d extent_of_floor(const PriorMap& map, const FixtureMap& fixtures) {
  const GridGeometry& geometry = map.geometry;
  if (geometry.size() > 0) {
    return {geometry.origin, geometry.origin + geometry.resolution * Eigen::Vector2d(geometry.columns, geometry.rows)};
  }
  Eigen::AlignedBox2d box = fixtures.extent();
  box.extend(fixtures.size() == 0 ? Eigen::Vector2d::Zero() : box.min());
  return {box.min() - Eigen::Vector2d::Constant(2.0), box.max() + Eigen::Vector2d::Constant(2.0)};
}

}  // namespace luminav
