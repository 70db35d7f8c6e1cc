#pragma once

#include <filesystem>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/mapper/grid_mapper.hpp"
#include "services/mapper/tile_schedule.hpp"

namespace luminav {

/// Everything the mapper is told at start.
struct MapperConfig {
  RobotDescription robot;
  GridMapperParams grid;
  TileScheduleParams tiles;
  PriorMap prior;                       ///< at `resolution`; all unknown where the building has no map
  double resolution = 0.1;              ///< [m] side of a cell; 10 cells per metre, as the paper
  double position_limit = 0.15;         ///< [m] 1-sigma of the pose above which nothing is drawn
  double heading_limit = radians(3.0);  ///< [rad] the same of the heading
  double turn_limit = 0.6;    ///< [rad/s] turning faster, nothing is drawn: errors of time become errors of angle
  double keep_period = 30.0;  ///< [s] between copies of the evidence to the state folder
  std::filesystem::path state_folder;  ///< where maps are saved and evidence survives a restart; "" = nowhere
};

/// Reads table [mapper] of the robot's file and the map of the building. Throws ConfigurationError.
MapperConfig read_mapper_config(const std::filesystem::path& robot_file, const std::filesystem::path& building_file);

/// A prior map that knows nothing, large enough for all that the building's file names and a margin [m] around it.
PriorMap unknown_map(const std::filesystem::path& building_file, double resolution, double margin);

}  // namespace luminav
