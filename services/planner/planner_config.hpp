#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/planner/execution/goal_executor.hpp"
#include "services/planner/path/route_planner.hpp"

namespace luminav {

/// Everything the planner is told at start.
struct PlannerConfig {
  RobotDescription robot;
  RoutePlannerParams route;
  GoalParams goals;
  std::vector<Door> doors;                  ///< for sentences: a blocked door is called one
  std::string building;                     ///< its name; "" = not told, then any place is taken as it comes
  std::vector<Place> places;                ///< of the building: a goal that names another one is for another building
  std::filesystem::path state_folder;       ///< where the goal list survives a restart; "" = nowhere
  std::string boot;                         ///< id of the machine's start; "" = unknown
  LocalClock local_clock = universal_time;  ///< by which zones have hours; of a process that of its machine

  /// What p3dx-mapping.toml sets: plans through what nobody has seen, and closer to walls, since doors look narrow on a
  /// map that is being drawn.
  void plan_on_a_new_map();
};

/// Reads table [planner] of the robot's file and doors, places and zones of the building. Throws ConfigurationError.
PlannerConfig read_planner_config(const std::filesystem::path& robot_file, const std::filesystem::path& building_file);

}  // namespace luminav
