#include "services/controller/following/local_map.hpp"

#include <algorithm>
#include <array>

namespace luminav {
namespace {

/// Is the cell a wall of the building's map? Disputed cells are not.
bool is_prior_wall(const OccupancyGrid& grid, const Cell& cell) {
  return grid.geometry.contains(cell) && grid.prior[grid.geometry.index(cell)] == Prior::kOccupied;
}

/// Is it a wall, or do the sonars say that something stands there?
bool is_occupied(const OccupancyGrid& grid, const Cell& cell, const LocalMapParams& params) {
  if (!grid.geometry.contains(cell)) {
    return false;
  }
  const std::size_t index = grid.geometry.index(cell);
  return grid.prior[index] == Prior::kOccupied || grid.evidence[index] > params.occupied * kEvidencePerLogOdds;
}

/// Does the cell belong to the inside of a thick wall, which no one can meet?
bool is_inside_wall(const OccupancyGrid& grid, const Cell& cell) {
  return is_prior_wall(grid, {cell.column - 1, cell.row}) && is_prior_wall(grid, {cell.column + 1, cell.row}) &&
         is_prior_wall(grid, {cell.column, cell.row - 1}) && is_prior_wall(grid, {cell.column, cell.row + 1});
}

}  // namespace

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

std::vector<Eigen::Vector2d> known_walls(const OccupancyGrid& grid, const Pose2& world_from_robot, double radius) {
  const Eigen::Vector2d robot = world_from_robot.position();
  const PointTransform robot_from_world = PointTransform::inverse_of(world_from_robot);
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(0.5 * grid.geometry.resolution);
  const Cell low = grid.geometry.cell_at(robot - Eigen::Vector2d(radius, radius));
  const Cell high = grid.geometry.cell_at(robot + Eigen::Vector2d(radius, radius));
  std::vector<Eigen::Vector2d> walls;
  for (int row = std::max(0, low.row); row <= std::min(grid.geometry.rows - 1, high.row); ++row) {
    const Prior* cells = grid.prior.data() + grid.geometry.index({0, row});
    for (int column = std::max(0, low.column); column <= std::min(grid.geometry.columns - 1, high.column); ++column) {
      const Cell cell{column, row};
      if (cells[column] != Prior::kOccupied || is_inside_wall(grid, cell)) {
        continue;
      }
      // the wall's face may be anywhere in the cell: the side turned to the robot counts
      const Eigen::Vector2d centre = grid.geometry.centre_of(cell);
      const Eigen::Vector2d face = robot.cwiseMax(centre - half).cwiseMin(centre + half);
      if ((face - robot).norm() <= radius) {
        walls.push_back(robot_from_world * face);
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
  for (double distance = 0.0; distance <= length; distance += 0.5 * grid.geometry.resolution) {
    for (const double side : std::array{-params.half_width, 0.0, params.half_width}) {
      const Eigen::Vector2d point = from_in_world + distance * along + side * across;
      // beside the robot itself the line does not ask: it stands there already
      if ((side == 0.0 || distance > 0.2) && is_occupied(grid, grid.geometry.cell_at(point), params)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace luminav
