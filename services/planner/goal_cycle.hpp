#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/planner/blockage.hpp"
#include "services/planner/route_planner.hpp"

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
  int losses = 10;                ///< how often the pose may get lost without progress before the goal is given up
  double map_timeout = 15.0;      ///< [s] to wait for all tiles of the map
  double blocked_wait = 10.0;     ///< [s] to wait for whatever stands in the way before a long way round
  double detour_ratio = 1.5;      ///< a way round this much longer is taken at once,
  double detour_length = 3.0;     ///< [m] and this much beside
  double hold_distance = 0.8;     ///< [m] before a blockage where the robot waits
  double replan_period = 0.3;     ///< [s] between two plans
  double keep_ratio = 0.85;       ///< a new way replaces a passable one when it costs less than this share of it
  double off_path = 0.6;          ///< [m] from the path before it is planned anew
  double no_progress_time = 6.0;  ///< [s] without progress before it is planned anew
  double progress_length = 0.2;   ///< [m] of the path that count as progress
  double give_up_wait = 60.0;     ///< [s] to wait when no other way is left: people come and go
  int attempts = 5;               ///< plans without progress before the robot calls itself stuck ...
  double stuck_time = 60.0;       ///< [s] ... and how long it must have tried
  double suspect_time = 60.0;     ///< [s] that a suspected obstacle stays
  double retry_wait = 20.0;       ///< [s] before a failed stop is tried again, policy retry
  int retries = 3;                ///< how often
};

/// What the controller said last.
struct ControlReport {
  bool at_goal = false;
  bool yielding = false;  // waits for somebody
  bool stuck = false;
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

/// Brings the robot to one stop after the other, and says in one sentence what it is doing. Every phase ends in bounded
/// time, in ARRIVED or in a cause. Time comes in with each call.
class GoalCycle {
 public:
  GoalCycle(const GoalCycleParams& params, const RoutePlannerParams& planner, std::vector<Door> doors);

  void start(const GoalRequest& goal, std::int64_t now);
  /// Goes on with a goal that an earlier run was busy with.
  void resume_at(const GoalRequest& goal, int stop_index, std::int64_t now);
  void cancel(std::int64_t id, std::int64_t now);
  void pause(std::int64_t id, std::int64_t now);
  void resume(std::int64_t id, std::int64_t now);
  /// A request that cannot be carried out; the goal at hand, if any, is given up.
  void refuse(std::int64_t id, const std::string& why, std::int64_t now);

  /// The map changed; the grid must outlive the next update. `received` of `tiles` are there.
  void map_changed(const OccupancyGrid& grid, int received, int tiles);
  void update(const Situation& situation);

  [[nodiscard]] bool is_active() const { return phase_ != Phase::kNone; }
  [[nodiscard]] const NavigationReport& report() const { return report_; }
  [[nodiscard]] const GoalPath& path() const { return path_; }
  [[nodiscard]] const GoalRequest& goal() const { return goal_; }
  [[nodiscard]] int stop_index() const { return stop_; }

 private:
  enum class Phase { kNone, kLocalizing, kPlanning, kFollowing, kHolding, kDwelling, kRetrying, kPaused };

  void begin(const GoalRequest& goal, int stop_index, std::int64_t now);
  void enter(Phase phase, NavigationState state, const std::string& cause);
  void finish(NavigationState state, const std::string& cause);
  void fail_stop(NavigationState state, const std::string& cause);
  void next_stop();
  void reached_stop();

  void lose_place(const std::string& why);
  [[nodiscard]] bool is_localized(const Situation& situation);
  void plan(const Situation& situation);
  void handle_no_route(const Situation& situation, const Route& route);
  void hold(const Situation& situation, const Polyline& way, std::size_t blocked_at, double reference_length);
  void update_hold(const Situation& situation);
  void follow(const Route& route);
  void update_following(const Situation& situation);
  void check_arrival(const Situation& situation);
  void check_progress(const Situation& situation);
  void check_path(const Situation& situation);
  void suspect_ahead(const Situation& situation);

  [[nodiscard]] Route plan_route(const Situation& situation);
  void refresh_space();
  void set_path(const Polyline& points);
  void advance_along(const Pose2& pose);
  [[nodiscard]] Polyline remaining(const Pose2& pose) const;
  /// What a path may end from the stop so that the robot, stopping there, is within the tolerance [m].
  [[nodiscard]] double planned_tolerance() const;
  [[nodiscard]] bool is_at_stop(const Pose2& pose) const;
  [[nodiscard]] double tolerance() const;
  [[nodiscard]] double heading_tolerance() const;
  [[nodiscard]] double seconds_since(std::int64_t utime) const { return static_cast<double>(now_ - utime) * 1e-6; }
  [[nodiscard]] const GoalStop& stop() const { return goal_.stops[static_cast<std::size_t>(stop_)]; }
  [[nodiscard]] std::string no_path_sentence(const Route& route) const;

  struct Suspect {
    SuspectedObstacle obstacle;
    std::int64_t until = 0;  // [us]
  };

  GoalCycleParams params_;
  RoutePlannerParams planner_params_;
  RoutePlanner planner_;
  std::vector<Door> doors_;

  const OccupancyGrid* grid_ = nullptr;
  int tiles_received_ = 0;
  int tiles_ = 0;
  bool map_dirty_ = true;
  std::vector<Suspect> suspects_;

  GoalRequest goal_;
  int stop_ = 0;
  Phase phase_ = Phase::kNone;
  Phase paused_phase_ = Phase::kNone;
  NavigationReport report_;
  GoalPath path_;
  std::size_t at_ = 0;  // index of the path's point nearest to the robot

  std::int64_t now_ = 0;             // [us]
  std::int64_t phase_since_ = 0;     // [us]
  std::int64_t last_tracking_ = 0;   // [us] 0 = not since the goal was taken up
  std::int64_t last_plan_ = 0;       // [us]
  std::int64_t progress_since_ = 0;  // [us]
  double progress_left_ = 0.0;       // [m] distance left when progress was made last
  double attempt_left_ = 0.0;        // [m] distance left when the attempts were counted from
  int attempts_ = 0;
  std::int64_t first_attempt_ = 0;  // [us]
  int losses_ = 0;
  double loss_left_ = 0.0;  // [m] distance left when losses were counted from
  int arrival_failures_ = 0;
  int retries_ = 0;
  int failures_in_a_row_ = 0;
  int skipped_ = 0;
  Blockage blockage_;
  std::string hold_reason_;
  double reference_length_ = 0.0;  // [m] of the way that was blocked
  std::int64_t hold_since_ = 0;    // [us] when the robot began to stand before the blockage; 0 = on its way there
};

}  // namespace luminav
