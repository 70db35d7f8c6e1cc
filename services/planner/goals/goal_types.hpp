#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/common/geometry/pose2.hpp"
#include "services/planner/path/path_shaping.hpp"

namespace luminav {

/// The numbers are those of NAVIGATION_STATUS.
enum class NavigationState : std::int8_t {
  kIdle = 0,
  kLocalizing = 1,
  kPlanning = 2,
  kFollowing = 3,
  kWaiting = 4,
  kArrived = 5,
  kNoPath = 6,
  kBlocked = 7,
  kStuck = 8,
  kCancelled = 9,
  kLost = 10,
  kPaused = 11
};

enum class FailurePolicy : std::int8_t { kSkip = 0, kRetry = 1, kStop = 2 };

struct GoalStop {
  std::string place;  // for people; may be ""
  Pose2 pose;         // world
  bool has_theta = false;
  double wait = 0.0;  // [s] to stay there
};

struct GoalRequest {
  std::int64_t id = 0;
  std::vector<GoalStop> stops;
  bool loop = false;
  FailurePolicy policy = FailurePolicy::kStop;
  double tolerance = 0.0;          // [m] 0 = default
  double heading_tolerance = 0.0;  // [rad] 0 = default
};

/// What a robot's file may set; what nobody tunes stands where it is used.
struct GoalParams {
  double tolerance = 0.22;                  ///< [m] a stop counts as reached within this
  double heading_tolerance = radians(5.0);  ///< [rad]
  double tracking_grace = 1.0;              ///< [s] without TRACKING before the robot goes searching
  double lost_timeout = 600.0;              ///< [s] of searching before the goal is given up
  int losses = 10;                ///< how often the pose may get lost without progress before the goal is given up
  double map_timeout = 15.0;      ///< [s] to wait for all tiles of the map
  double blocked_wait = 10.0;     ///< [s] to wait for whatever stands in the way before a long detour
  double detour_ratio = 1.5;      ///< a detour this much longer is taken at once,
  double detour_length = 3.0;     ///< [m] and this much beside
  double replan_period = 0.3;     ///< [s] between two plans
  double no_progress_time = 6.0;  ///< [s] without progress before it is planned anew
  double search_ratio = 4.0;      ///< where there is no building's map, a goal is given up after driving so many times
  double search_length = 60.0;    ///< [m] its first path and this: each room has walls where a path was hoped for
  double give_up_wait = 100.0;    ///< [s] to wait when no other path is left: people come and go, and the mapper
                                  ///< forgets within 90 s (its decay_time) what nobody sees any more
  int attempts = 5;               ///< plans without progress before the robot calls itself stuck ...
  double stuck_time = 60.0;       ///< [s] ... and how long it must have tried, ...
  double people_time = 180.0;     ///< [s] ... while somebody is in the way every now and then
  double retry_wait = 20.0;       ///< [s] before a failed stop is tried again, policy retry
  int retries = 3;                ///< how often
  double touch_ahead = 0.36;      ///< [m] from the wheel axis to the middle of what it drove against: by its outline
};

/// What the controller said last.
struct ControlReport {
  bool at_goal = false;
  bool yielding = false;  // waits for somebody
  bool stuck = false;
  bool follows = false;  // the path, forwards
  int path_sequence = 0;
  double seconds_without_progress = 0.0;  // [s]
  std::string reason;
};

/// Everything the goal executor knows of the moment.
struct Situation {
  std::int64_t now = 0;                  // [us] stamp of the newest POSE or ROBOT_STATUS
  bool tracking = false;                 // the pose is fresh and good
  Pose2 world_from_robot;                // meaningful while tracking
  std::string localization;              // why it is not tracking, one sentence
  bool can_move = true;                  // base connected, motors on, no stop engaged
  std::string cannot_move;               // why not
  bool has_touched = false;              // drove against something since the last time: wheels blocked, bumper pressed
  std::optional<ControlReport> control;  // nothing: silent for too long
};

struct NavigationReport {
  NavigationState state = NavigationState::kIdle;
  std::string cause;
  std::int64_t goal_id = 0;  // of the last request taken up
  int stop_index = 0;
  int stop_count = 0;
  std::optional<GoalStop> target;
  double distance_left = 0.0;  // [m]
  int replans = 0;
};

/// The path that the controller is to follow.
struct GoalPath {
  int sequence = 0;  // grows with each new path, empty ones included
  std::int64_t goal_id = 0;
  int stop_index = 0;
  Polyline points;          // empty = stand still
  double tolerance = 0.18;  // [m]
  bool has_theta = false;
  double theta = 0.0;                       // [rad]
  double heading_tolerance = radians(5.0);  // [rad]
};

}  // namespace luminav
