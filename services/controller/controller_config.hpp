#pragma once

#include <filesystem>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/controller/following/local_map.hpp"
#include "services/controller/following/path_follower.hpp"
#include "services/controller/following/progress_monitor.hpp"
#include "services/controller/safety/echo_memory.hpp"
#include "services/controller/safety/sonar_watch.hpp"
#include "services/controller/safety/stop_logic.hpp"
#include "services/controller/safety/touch_memory.hpp"
#include "services/controller/search/wander.hpp"

namespace luminav {

/// Everything the controller is told: the robot, and table [controller] of its file.
struct ControllerConfig {
  RobotDescription robot;
  Building building;  // without fixtures: a robot that does not know where it is searches by sonar alone
  PriorMap walls;     // of its map, empty = none
  EchoMemoryParams echo_memory;
  SonarWatchParams sonar_watch;
  TouchMemoryParams touch_memory;
  StopLogicParams stop_logic;
  LocalMapParams local_map;
  PathFollowerParams follower;
  WanderParams wander;
  ProgressParams progress;
  double jerk = 1.0;                  // [m/s^3] of speeding up
  double period = 0.04;               // [s] of control; commands are re-sent with every tick between
  double pose_stale_after = 0.25;     // [s] against the newest odometry: two poses missing of ten a second
  double planner_silent_after = 3.0;  // [s] without NAVIGATION_STATUS
  double teleop_silent_after = 0.3;   // [s] dead man
  double teleop_pause = 1.0;          // [s] after a person let go, before it drives by itself again
  double patience = 6.5;              // [s] it waits for people to go away
  double patience_searching = 3.0;    // [s] the same while it can as well look elsewhere
  double patience_with_things = 1.5;  // [s] the same for what never moved
  double people_within = 2.0;         // [m] something that comes nearer within it is a person
  double people_remembered = 8.0;     // [s]
  double settle_after = 1.5;          // [s] blocked within the tolerance counts as arrived
  double stuck_after = 5.0;           // [s] without progress
  double stuck_after_people = 30.0;   // [s] the same while people come towards it
  double escape_pause = 3.0;          // [s] between two escapes
  double escaped_after = 1.0;         // [m] from the place of the first escape
  int max_escapes = 3;                // at one place; more is going in circles
  double care_within = 0.5;           // [m] of something that no map has
  double min_care = 0.4;              // share of the robot's limits left when it is that near
  double news_slow = 0.45;            // [m] from something new ahead it drives at `news_speed`
  double news_free = 0.95;            // [m] and at full speed
  double news_speed = 0.20;           // [m/s] stops within the tenth of a metre that people keep
  double news_age = 0.5;              // [s] since it was heard; a newer firing has the say then
  double hold_within = 0.35;          // [m] of something that no map has and that stops it: stands quite still
  double hold_pause = 1.0;            // [s] after that it tries by itself
  double wall_clearance = 0.28;       // [m] from the building's walls to where the robot's middle may be

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
