#include "services/controller/local_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace luminav {

bool is_prior_wall(const OccupancyGrid& grid, const Cell& cell) {
  return grid.geometry.contains(cell) && grid.prior[grid.geometry.index(cell)] == Prior::kOccupied;
}

bool is_occupied(const OccupancyGrid& grid, const Cell& cell, const LocalMapParams& params) {
  if (!grid.geometry.contains(cell)) {
    return false;
  }
  const std::size_t index = grid.geometry.index(cell);
  return grid.prior[index] == Prior::kOccupied || grid.evidence[index] > params.occupied * kEvidencePerLogOdds;
}

bool has_wall_near(const OccupancyGrid& grid, const Eigen::Vector2d& point_in_world, double distance) {
  const Eigen::Vector2d reach(distance, distance);
  const Cell low = grid.geometry.cell_at(point_in_world - reach);
  const Cell high = grid.geometry.cell_at(point_in_world + reach);
  const double half = 0.5 * grid.geometry.resolution;
  for (int row = low.row; row <= high.row; ++row) {
    for (int column = low.column; column <= high.column; ++column) {
      if (!is_prior_wall(grid, {column, row})) {
        continue;
      }
      // to the cell's square, not its centre
      const Eigen::Vector2d offset =
          (grid.geometry.centre_of({column, row}) - point_in_world).cwiseAbs() - Eigen::Vector2d(half, half);
      if (offset.cwiseMax(0.0).norm() <= distance) {
        return true;
      }
    }
  }
  return false;
}

std::vector<ObstaclePoint> known_walls(const OccupancyGrid& grid, const Pose2& world_from_robot,
                                       const LocalMapParams& params) {
  std::vector<ObstaclePoint> walls;
  const Eigen::Vector2d reach(params.radius, params.radius);
  const Cell low = grid.geometry.cell_at(world_from_robot.position() - reach);
  const Cell high = grid.geometry.cell_at(world_from_robot.position() + reach);
  const Pose2 robot_from_world = world_from_robot.inverse();
  const Eigen::Vector2d half_cell(0.5 * grid.geometry.resolution, 0.5 * grid.geometry.resolution);
  for (int row = std::max(0, low.row); row <= std::min(grid.geometry.rows - 1, high.row); ++row) {
    for (int column = std::max(0, low.column); column <= std::min(grid.geometry.columns - 1, high.column); ++column) {
      if (!is_prior_wall(grid, {column, row})) {
        continue;
      }
      // the inside of a thick wall is behind its face
      const bool is_inside = is_prior_wall(grid, {column - 1, row}) && is_prior_wall(grid, {column + 1, row}) &&
                             is_prior_wall(grid, {column, row - 1}) && is_prior_wall(grid, {column, row + 1});
      const Eigen::Vector2d centre = grid.geometry.centre_of({column, row});
      // the wall's face may be anywhere in the cell: take the side towards the robot
      const Eigen::Vector2d face =
          world_from_robot.position().cwiseMax(centre - half_cell).cwiseMin(centre + half_cell);
      if (!is_inside && (face - world_from_robot.position()).norm() <= params.radius) {
        walls.push_back({robot_from_world * face, 0.0, 0.0, true});
      }
    }
  }
  return walls;
}

bool is_line_free(const OccupancyGrid& grid, const Eigen::Vector2d& from_in_world, const Eigen::Vector2d& to_in_world,
                  const LocalMapParams& params) {
  const Eigen::Vector2d step = to_in_world - from_in_world;
  const double length = step.norm();
  if (length < 1e-6) {
    return true;
  }
  const Eigen::Vector2d along = step / length;
  const Eigen::Vector2d across(-along.y(), along.x());
  for (double way = 0.0; way <= length; way += 0.5 * grid.geometry.resolution) {
    for (const double side : std::array{-params.half_width, 0.0, params.half_width}) {
      const Eigen::Vector2d point = from_in_world + way * along + side * across;
      // beside the robot itself the line does not ask: it stands there already
      if ((side == 0.0 || way > 0.2) && is_occupied(grid, grid.geometry.cell_at(point), params)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace luminav
