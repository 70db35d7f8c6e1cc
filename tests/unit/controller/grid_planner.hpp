#pragma once

#include <Eigen/Core>
#include <cmath>
#include <queue>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav::testing {

/// Dijkstra with a price on little clearance: good enough paths for closed-loop tests of the controller. Empty when
/// there is no way that keeps 0.26 m.
inline std::vector<Eigen::Vector2d> plan_path(const OccupancyGrid& grid, const Eigen::Vector2d& start,
                                              const Eigen::Vector2d& goal) {
  const GridGeometry& geometry = grid.geometry;
  std::vector<double> clearance(geometry.size(), 9.0);  // [m], exact enough by a window
  constexpr int kWindow = 6;
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      const std::size_t index = geometry.index({column, row});
      if (grid.prior[index] != Prior::kOccupied && grid.evidence[index] < 20) {
        continue;
      }
      for (int dr = -kWindow; dr <= kWindow; ++dr) {
        for (int dc = -kWindow; dc <= kWindow; ++dc) {
          const Cell cell{column + dc, row + dr};
          if (geometry.contains(cell)) {
            double& nearest = clearance[geometry.index(cell)];
            nearest = std::min(nearest, geometry.resolution * std::hypot(dr, dc));
          }
        }
      }
    }
  }
  const Cell first = geometry.cell_at(start);
  const Cell last = geometry.cell_at(goal);
  if (!geometry.contains(first) || !geometry.contains(last)) {
    return {};
  }
  std::vector<double> cost(geometry.size(), 1e18);
  std::vector<Cell> next(geometry.size());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost[geometry.index(last)] = 0.0;
  open.emplace(0.0, geometry.index(last));
  while (!open.empty()) {
    const auto [so_far, index] = open.top();
    open.pop();
    if (so_far > cost[index]) {
      continue;
    }
    const Cell cell{static_cast<int>(index) % geometry.columns, static_cast<int>(index) / geometry.columns};
    for (int dr = -1; dr <= 1; ++dr) {
      for (int dc = -1; dc <= 1; ++dc) {
        const Cell other{cell.column + dc, cell.row + dr};
        if ((dr == 0 && dc == 0) || !geometry.contains(other)) {
          continue;
        }
        const double room = clearance[geometry.index(other)];
        const bool is_start_area = std::hypot(other.column - first.column, other.row - first.row) < 4.0;
        if (room < 0.26 && !(is_start_area && room > 0.0)) {
          continue;
        }
        const double step = geometry.resolution * std::hypot(dr, dc) * (1.0 + 3.0 * std::max(0.0, 0.6 - room));
        if (so_far + step < cost[geometry.index(other)]) {
          cost[geometry.index(other)] = so_far + step;
          next[geometry.index(other)] = cell;
          open.emplace(so_far + step, geometry.index(other));
        }
      }
    }
  }
  if (cost[geometry.index(first)] > 1e17) {
    return {};
  }
  std::vector<Eigen::Vector2d> path{start};
  for (Cell cell = first; !(cell == last);) {
    cell = next[geometry.index(cell)];
    path.push_back(geometry.centre_of(cell));
  }
  path.back() = goal;
  return path;
}

}  // namespace luminav::testing
