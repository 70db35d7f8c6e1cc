#include "services/surveyor/explore/tried_floor.hpp"

#include <cmath>
#include <set>

namespace luminav {
namespace {

constexpr double kCell = 0.1;  // [m]
constexpr long kAround = 2;    // [cells] beside a point: an estimate may shift the map a little

std::pair<long, long> cell_of(const Eigen::Vector2d& point) {
  return {static_cast<long>(std::floor(point.x() / kCell)), static_cast<long>(std::floor(point.y() / kCell))};
}

}  // namespace

void TriedFloor::add(const std::vector<Eigen::Vector2d>& points) {
  std::set<std::pair<long, long>> cells;
  for (const Eigen::Vector2d& point : points) {
    const auto [column, row] = cell_of(point);
    for (long dr = -kAround; dr <= kAround; ++dr) {
      for (long dc = -kAround; dc <= kAround; ++dc) {
        cells.insert({column + dc, row + dr});
      }
    }
  }
  for (const std::pair<long, long>& cell : cells) {
    ++tries_[cell];
  }
}

int TriedFloor::tries(const Eigen::Vector2d& point) const {
  const auto found = tries_.find(cell_of(point));
  return found == tries_.end() ? 0 : found->second;
}

}  // namespace luminav
