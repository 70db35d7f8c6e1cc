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

struct GoalCycleParams {
  double tolerance = 0.22;                  ///< [m] a stop counts as reached within this
  double heading_tolerance = radians(5.0);  ///< [rad]
  double tracking_grace = 1.0;              ///< [s] without TRACKING before the robot goes searching
  double lost_timeout = 600.0;              ///< [s] of searching before the goal is given up
  int losses = 10;                   ///< how often the pose may get lost without progress before the goal is given up
  double map_timeout = 15.0;         ///< [s] to wait for all tiles of the map
  double suspect_place_time = 25.0;  ///< [s] to doubt a place in a wall of the building's map before a goal is refused,
  double suspect_place_still = 4.0;  ///< [s] of it standing still, since somebody may be carrying the robot,
  double suspect_place_turn = 4.0;   ///< [s] then for each third of a turn in which it looks round
  double blocked_wait = 10.0;        ///< [s] to wait for whatever stands in the way before a long way round
  double detour_ratio = 1.5;         ///< a way round this much longer is taken at once,
  double detour_length = 3.0;        ///< [m] and this much beside
  double detour_memory = 300.0;      ///< [s] after taking it, what was seen at the blockage counts as standing there
  double detour_radius = 1.5;        ///< [m] round the blockage
  double hold_distance = 0.8;        ///< [m] before a blockage where the robot waits
  double hold_tolerance = 0.3;       ///< [m] for getting there
  double come_nearer = 0.2;          ///< [m] nearer than before: what blocks a door is somebody who wants to get out
  int waits_beside = 3;              ///< how often, on the way to a stop, the robot waits beside a door for that
  double facing_after = 10.0;        ///< [s] of waiting after which it looks whether what blocks it is still there,
  double facing_period = 3.0;        ///< [s] between two turns for that
  double facing_angle = 0.21;        ///< [rad] within which the robot faces it already: there the sonar cones overlap
  double replan_period = 0.3;        ///< [s] between two plans
  double keep_ratio = 0.85;          ///< a new path replaces a passable one if it costs less than this share of it
  double off_path = 0.6;             ///< [m] from the path before it is planned anew
  double no_progress_time = 6.0;     ///< [s] without progress before it is planned anew
  double progress_length = 0.2;      ///< [m] of the path that count as progress
  double look_again = 20.0;  ///< [s] after which a goal that lies in an obstacle is looked at from as near as can be
  double suspect_log_odds = 1.8;  ///< where there is no building's map, evidence below is a gap worth a look from near
  double sure_log_odds = 2.4;     ///< when there is none: evidence below this,
  double surest_log_odds = 3.2;   ///< and then this
  double gap_distance = 0.25;     ///< [m] before it: from farther away its posts are all that is heard
  double gap_wait = 4.0;          ///< [s] to look at it
  int gap_looks = 12;             ///< how many of them for a stop, and as many again from elsewhere
  double gap_ratio = 1.2;         ///< a way round the gap this much longer than through it is not taken before,
  double gap_detour = 1.0;        ///< [m] and this much beside: it leads through what nobody has seen
  double unknown_ratio = 3.0;     ///< a way through what nobody has seen counts so many times as long: walls are there
  double search_ratio = 4.0;      ///< where there is no building's map, a goal is given up after driving so many times
  double search_length = 60.0;    ///< [m] its first way and this: each room has walls where a way was hoped for
  double give_up_wait = 100.0;    ///< [s] to wait when no other way is left: people come and go, and the mapper
                                  ///< forgets within 90 s (its decay_time) what nobody sees any more
  int attempts = 5;               ///< plans without progress before the robot calls itself stuck ...
  double stuck_time = 60.0;       ///< [s] ... and how long it must have tried, ...
  double people_time = 180.0;     ///< [s] ... while somebody is in the way every now and then,
  double people_memory = 20.0;    ///< [s] that is, at most so long ago
  double suspect_time = 60.0;     ///< [s] that a suspected obstacle stays
  double touch_ahead = 0.36;      ///< [m] from the wheel axis to the middle of what the robot drove against
  double touch_time = 180.0;      ///< [s] that it stays
  double retry_wait = 20.0;       ///< [s] before a failed stop is tried again, policy retry
  int retries = 3;                ///< how often
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

/// Everything the goal cycle knows of the moment.
struct Situation {
  std::int64_t now = 0;                  // [us] stamp of the newest POSE or ROBOT_STATUS
  bool tracking = false;                 // the pose is fresh and good
  Pose2 world_from_robot;                // meaningful while tracking
  std::string localization;              // why it is not tracking, one sentence
  bool can_move = true;                  // base connected, motors on, no stop engaged
  std::string cannot_move;               // why not
  bool is_blocked = false;               // wheels blocked or a bumper pressed
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

/// The way that the controller shall follow.
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
