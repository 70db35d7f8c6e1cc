#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

struct LocalMapParams {
  double radius = 1.5;       // [m] around the robot within which cells count
  double occupied = 0.8;     // log-odds above which evidence counts as an obstacle, the planner's threshold
  double half_width = 0.22;  // [m] of the strip that must be free for a line of sight
};

/// True if a wall of the building's map is within a distance [m] of a world point.
bool has_wall_near(const OccupancyGrid& grid, const Eigen::Vector2d& point_in_world, double distance);

/// Walls of the building's map within a radius [m] of the robot, in its frame: of each cell the point nearest to the
/// wheel axis.
std::vector<Eigen::Vector2d> known_walls(const OccupancyGrid& grid, const Pose2& world_from_robot, double radius);

/// True if a strip of the robot's width is free between two world points. Outside the grid it is.
bool is_line_free(const OccupancyGrid& grid, const Eigen::Vector2d& from_in_world, const Eigen::Vector2d& to_in_world,
                  const LocalMapParams& params);

}  // namespace luminav
