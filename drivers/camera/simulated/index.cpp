#include "drivers/camera/simulated/index.hpp"

#include <algorithm>
#include <cmath>

namespace luminav::simulated {

std::int64_t PointIndex::cell_of(double coordinate) {
  return static_cast<std::int64_t>(std::floor(coordinate / kCell));
}

std::int64_t PointIndex::key_of(std::int64_t column, std::int64_t row) {
  return column * 1'000'003 + row;
}

PointIndex::PointIndex(const std::vector<Eigen::Vector2d>& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    cells_[key_of(cell_of(points[i].x()), cell_of(points[i].y()))].push_back(static_cast<int>(i));
  }
}

void PointIndex::near(const Eigen::Vector2d& centre, double radius, std::vector<int>& found) const {
  found.clear();
  for (std::int64_t row = cell_of(centre.y() - radius); row <= cell_of(centre.y() + radius); ++row) {
    for (std::int64_t column = cell_of(centre.x() - radius); column <= cell_of(centre.x() + radius); ++column) {
      const auto cell = cells_.find(key_of(column, row));
      if (cell != cells_.end()) {
        found.insert(found.end(), cell->second.begin(), cell->second.end());
      }
    }
  }
  std::sort(found.begin(), found.end());
}

}  // namespace luminav::simulated
