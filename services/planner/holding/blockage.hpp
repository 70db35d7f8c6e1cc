#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/planner/path/path_shaping.hpp"
#include "services/planner/space/configuration_space.hpp"

namespace luminav {

/// What stands in the way, in numbers.
struct Blockage {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // [m] world
  bool is_door = false;
  double free_width = 0.0;  // [m] the widest gap across the path
  double need = 0.6;        // [m] that the robot needs

  /// "door at (4.2, 3.1) is blocked, 0.4 m free, need 0.6 m"
  [[nodiscard]] std::string sentence() const;
};

/// Measures the gap across a path where it is blocked first (at `index`); along the opening where a door is near.
Blockage measure_blockage(const ConfigurationSpace& space, const std::vector<Door>& doors, const Polyline& path,
                          std::size_t index, double need);

/// The centre [m, world] of the cell that blocks a path first and is no wall of the building's map: of those within
/// `radius` [m] of the first blocked point that has any, the one nearest to the path's start. There the robot is: that
/// point is not asked. Only what sonars have drawn counts; nothing where all is wall, unknown or merely suspected.
std::optional<Eigen::Vector2d> what_blocks(const ConfigurationSpace& space, const OccupancyGrid& grid,
                                           const Polyline& path, double radius);

}  // namespace luminav
