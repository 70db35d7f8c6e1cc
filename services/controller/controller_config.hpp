#pragma once

#include <filesystem>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/controller/following/local_map.hpp"
#include "services/controller/following/path_follower.hpp"
#include "services/controller/safety/echo_memory.hpp"
#include "services/controller/safety/stop_logic.hpp"
#include "services/controller/search/wander.hpp"

namespace luminav {

/// Everything the controller is told: the robot, and table [controller] of its file.
struct ControllerConfig {
  RobotDescription robot;
  Building building;  // without fixtures: a robot that does not know where it is searches by sonar alone
  PriorMap walls;     // of its map, empty = none
  LocalClock local_clock = universal_time;  // by which zones have hours; of a process that of its machine
  EchoMemoryParams echo_memory;
  StopLogicParams stop_logic;
  LocalMapParams local_map;
  PathFollowerParams follower;
  WanderParams wander;
  double jerk = 1.0;         // [m/s^3] of speeding up
  double period = 0.04;      // [s] of control; commands are re-sent with every tick between
  double patience = 6.5;     // [s] it waits for people to go away
  double stuck_after = 5.0;  // [s] without progress

  /// A configuration whose speeds follow the robot's limits.
  static ControllerConfig for_robot(const RobotDescription& robot);
  /// Takes over what follows from the outline, the margin and the greatest speeds.
  void follow_margin_and_speeds();
  /// From how far [m] along the floor the camera may see a fixture, whatever its heading: a little more than to the
  /// nearer border of its image.
  [[nodiscard]] double view_radius() const;
};

/// Reads the robot's file with its table [controller] strictly. Throws ConfigurationError.
/// With a building's file it searches by what that predicts.
ControllerConfig read_controller_config(const std::filesystem::path& robot_file,
                                        const std::filesystem::path& building_file = {});

}  // namespace luminav
