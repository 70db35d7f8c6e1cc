#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "drivers/simulator/world/world_truth.hpp"
#include "services/mapper/grid_mapper.hpp"

namespace luminav {

/// A drive through a building on sonars that lie as real ones do: from the simulator, 25 pulses a second in each of two
/// arrays, while the robot walks along planned ways at 0.4 m/s.
struct MappingDrive {
  std::filesystem::path building_file;  // its map is the truth
  std::filesystem::path robot_file;
  std::vector<Eigen::Vector2d> waypoints;  // [m] world
  std::vector<Obstacle> obstacles;         // stand there, the map does not know
  bool use_prior = false;                  // the mapper knows the building's map
  GridMapperParams params;
  double position_noise = 0.02;         // [m] 1 sigma of the pose, slowly varying
  double heading_noise = radians(0.7);  // [rad]
  std::uint64_t seed = 1;
};

/// How good a map is, against the true walls.
struct MapQuality {
  double wall_median = 0.0;  // [m] of occupied cells to the nearest true surface
  double wall_p95 = 0.0;     // [m]
  double recall =
      0.0;  // of wall faces that came within 3 m and 60 degrees of an axis: an occupied cell within one cell
  double free_precision = 0.0;  // of cells called free
  int occupied_cells = 0;
  int free_cells = 0;
  int phantom_cells = 0;   // occupied by evidence alone, and nothing is within 0.15 m
  int obstacle_cells = 0;  // occupied by evidence in or beside an obstacle that the map does not know
  PriorMap map;
};

MapQuality drive_and_map(const MappingDrive& drive);

}  // namespace luminav
