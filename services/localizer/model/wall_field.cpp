#include "services/localizer/model/wall_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luminav {
namespace {

/// Squared distances along one line, in cells: lower envelope of parabolas, Felzenszwalb and Huttenlocher 2012.
void transform_line(const std::vector<float>& source, std::vector<float>& target, std::vector<int>& apex,
                    std::vector<float>& border) {
  const int n = static_cast<int>(source.size());
  int last = 0;
  apex[0] = 0;
  border[0] = -std::numeric_limits<float>::infinity();
  border[1] = std::numeric_limits<float>::infinity();
  const auto crossing = [&](int q, int p) {
    return ((source[static_cast<std::size_t>(q)] + static_cast<float>(q) * static_cast<float>(q)) -
            (source[static_cast<std::size_t>(p)] + static_cast<float>(p) * static_cast<float>(p))) /
           static_cast<float>(2 * (q - p));
  };
  for (int q = 1; q < n; ++q) {
    float s = crossing(q, apex[static_cast<std::size_t>(last)]);
    while (last > 0 && s <= border[static_cast<std::size_t>(last)]) {
      --last;
      s = crossing(q, apex[static_cast<std::size_t>(last)]);
    }
    ++last;
    apex[static_cast<std::size_t>(last)] = q;
    border[static_cast<std::size_t>(last)] = s;
    border[static_cast<std::size_t>(last) + 1] = std::numeric_limits<float>::infinity();
  }
  int k = 0;
  for (int q = 0; q < n; ++q) {
    while (border[static_cast<std::size_t>(k) + 1] < static_cast<float>(q)) {
      ++k;
    }
    const float offset = static_cast<float>(q - apex[static_cast<std::size_t>(k)]);
    target[static_cast<std::size_t>(q)] =
        offset * offset + source[static_cast<std::size_t>(apex[static_cast<std::size_t>(k)])];
  }
}

}  // namespace

WallField::WallField(const PriorMap& map) : map_(resample(map, kResolution)) {
  const auto columns = static_cast<std::size_t>(map_.geometry.columns);
  const auto rows = static_cast<std::size_t>(map_.geometry.rows);
  if (columns == 0 || rows == 0) {
    return;
  }
  // along the columns first, [cells]; a wall so far off that a byte does not hold it is none
  constexpr int kNone = 255;
  std::vector<std::uint8_t> distance(columns * rows);
  const auto one_farther = [&](std::size_t i) { return std::min(kNone, distance[i] + 1); };
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const int below = i >= columns ? one_farther(i - columns) : kNone;
    distance[i] = static_cast<std::uint8_t>(map_.cells[i] == Prior::kOccupied ? 0 : below);
  }
  for (std::size_t i = distance.size() - columns; i-- > 0;) {
    distance[i] = static_cast<std::uint8_t>(std::min<int>(distance[i], one_farther(i + columns)));
  }
  std::vector<int> apex(columns + 1);
  std::vector<float> border(columns + 2);
  std::vector<float> line(columns);
  std::vector<float> result(columns);
  tile_columns_ = (columns + kTile - 1) / kTile;
  tiles_.assign(tile_columns_ * ((rows + kTile - 1) / kTile) * kTile * kTile, 0);
  for (std::size_t row = 0; row < rows; ++row) {
    const auto first = distance.begin() + static_cast<std::ptrdiff_t>(row * columns);
    std::transform(first, first + static_cast<std::ptrdiff_t>(columns), line.begin(), [](std::uint8_t cells) {
      return cells == kNone ? 1e8F : static_cast<float>(cells) * static_cast<float>(cells);
    });
    transform_line(line, result, apex, border);
    for (std::size_t column = 0; column < columns; ++column) {
      const double centimetres = 100.0 * map_.geometry.resolution * std::sqrt(static_cast<double>(result[column]));
      tiles_[tiled(column, row)] = static_cast<std::uint8_t>(std::min(250.0, centimetres));
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

}  // namespace luminav
