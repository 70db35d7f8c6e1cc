#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/planner/goals/blockage.hpp"
#include "services/planner/goals/goal_types.hpp"
#include "services/planner/goals/path_progress.hpp"
#include "services/planner/path/route_planner.hpp"

namespace luminav {

/// Brings the robot to one stop after the other, and says in one sentence what it is doing. Every phase ends in bounded
/// time, in ARRIVED or in a cause. Time comes in with each call.
class GoalCycle {
 public:
  GoalCycle(const GoalCycleParams& params, const RoutePlannerParams& planner, std::vector<Door> doors);

  void start(const GoalRequest& goal, std::int64_t now);
  /// Goes on with a goal that an earlier run was busy with.
  void resume_at(const GoalRequest& goal, int stop_index, std::int64_t now);
  /// Shows such a goal as paused, and why; it goes on when it is resumed.
  void show_paused(const GoalRequest& goal, int stop_index, const std::string& why, std::int64_t now);
  void cancel(std::int64_t id, std::int64_t now);
  void pause(std::int64_t id, std::int64_t now);
  void resume(std::int64_t id, std::int64_t now);
  /// A request that cannot be carried out; the goal at hand, if any, is given up.
  void refuse(std::int64_t id, const std::string& why, std::int64_t now);

  /// The map changed; the grid must outlive the next update. `received` of `tiles` are there.
  void map_changed(const OccupancyGrid& grid, int received, int tiles);
  void update(const Situation& situation);

  [[nodiscard]] bool is_active() const { return phase_ != Phase::kNone; }
  [[nodiscard]] bool is_paused() const { return phase_ == Phase::kPaused; }
  [[nodiscard]] const NavigationReport& report() const { return report_; }
  [[nodiscard]] const GoalPath& path() const { return path_; }
  [[nodiscard]] const GoalRequest& goal() const { return goal_; }
  [[nodiscard]] int stop_index() const { return stop_; }

 private:
  static constexpr double kSkipBesideRobot = 0.35;   // [m] of the path: what is that near is the controller's business
  static constexpr double kAttemptsForgotten = 1.0;  // [m] of progress after which failures count from zero again

  enum class Phase {
    kNone,
    kLocalizing,
    kPlanning,
    kSuspectingPlace,
    kFollowing,
    kHolding,
    kDwelling,
    kRetrying,
    kPaused
  };

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
  /// Where the building's map has the robot walled in, the pose is wrong rather than the goal out of reach: stands
  /// still, then looks round. False when that has gone on for too long.
  bool suspect_place(const Situation& situation);
  void hold(const Polyline& path, std::size_t blocked_at, double reference_length);
  /// Leaves a place in the way of whoever comes through a door, and waits beside the door. False where there is no
  /// room.
  bool wait_beside(const Door& door, const Polyline& path);
  /// The door before or in which the robot holds, if it has not waited beside one too often.
  [[nodiscard]] const Door* blocking_door() const;
  /// How far [m] from the place of the hold something stands on the blocked way; walls are nothing.
  [[nodiscard]] double distance_of_what_blocks() const;
  /// Somebody comes out of the door before which the robot holds.
  void make_way(const Situation& situation);
  void update_hold(const Situation& situation);
  /// No way leads on: looks again, gives up in the end, and meanwhile makes way and faces what blocks.
  void keep_holding(const Situation& situation, const Route& route);
  void look_again(const Situation& situation, const Route& route);
  /// Turns the robot, where it stands and waits, towards what blocks its way.
  void face_blockage(const Situation& situation);
  /// Where no building's map tells walls from what sonars draw wrongly: drives to the gap that would make the way much
  /// shorter, or possible, to look at it from near. False when there is none left.
  bool look_at_gap(const Situation& situation, const Route& route);
  void follow(const Route& route);
  void update_following(const Situation& situation);
  void watch_yielding(const Situation& situation);
  void check_arrival(const Situation& situation);
  void check_progress(const Situation& situation);
  void check_path(const Situation& situation);
  /// Length [m] of a way, more of it where nobody has seen what is there.
  [[nodiscard]] double length_with_unknown(const Polyline& points) const;
  /// True once it has driven so much without finding a way that the stop is given up.
  [[nodiscard]] bool searches_in_vain(const Situation& situation);
  void suspect_ahead(const Situation& situation);
  void suspect_people(const Situation& situation);
  void suspect_touched(const Situation& situation);
  void suspect(const SuspectedObstacle& obstacle, double seconds);
  void suspect_blockage();

  [[nodiscard]] Route plan_route(const Situation& situation);
  void refresh_space();
  void set_path(const Polyline& points);
  /// To where it stands still for a while, not just so, with a heading [rad, world].
  void set_path_to_wait(const Polyline& points, double theta);
  /// From the robot along what is left of the path.
  [[nodiscard]] Polyline remaining(const Pose2& pose) const { return rest_of(path_.points, at_, pose.position()); }
  /// What a path may end from the stop so that the robot, stopping there, is within the tolerance [m].
  [[nodiscard]] double planned_tolerance() const;
  [[nodiscard]] bool is_at_stop(const Pose2& pose) const;
  /// The controller says that it has come to the end of the newest path.
  [[nodiscard]] bool is_at_end(const Situation& situation) const {
    return situation.control && situation.control->at_goal && situation.control->path_sequence == path_.sequence;
  }
  [[nodiscard]] double tolerance() const { return goal_.tolerance > 0.0 ? goal_.tolerance : params_.tolerance; }
  [[nodiscard]] double heading_tolerance() const {
    return goal_.heading_tolerance > 0.0 ? goal_.heading_tolerance : params_.heading_tolerance;
  }
  [[nodiscard]] double seconds_since(std::int64_t utime) const { return static_cast<double>(now_ - utime) * 1e-6; }
  [[nodiscard]] const GoalStop& stop() const { return goal_.stops[static_cast<std::size_t>(stop_)]; }

  /// How a stop is looked for where no building's map says what is behind a wall.
  struct Search {
    std::vector<SuspectedObstacle> looked_at;  // gaps that stayed shut when seen from near
    bool has_looked_twice = false;             // at all of them
    double first_length = 0.0;                 // [m] of the first way
    double driven = 0.0;                       // [m]
    std::optional<Eigen::Vector2d> last;       // where the robot was seen last

    void expect(double length) { first_length = first_length > 0.0 ? first_length : length; }
  };

  /// Somebody whom it waits for on its way.
  struct Waiting {
    Eigen::Vector2d place;  // [m] of the robot
    std::string cause;
  };

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
  NavigationReport report_;
  std::optional<std::string> cause_before_;  // of the report, before the pose was lost for a moment
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
  std::int64_t last_yield_ = 0;     // [us] when it waited for somebody last
  std::optional<Waiting> waits_;
  bool has_left_people_ = false;  // to go round, on the way to this stop
  bool was_blocked_ = false;      // wheels or bumpers, and stood against something
  int losses_ = 0;
  double loss_left_ = 0.0;  // [m] distance left when losses were counted from
  int suspicions_ = 0;      // how often its place could not be, on the way to this stop
  int looks_round_ = 0;     // thirds of a turn, of this doubt
  int waits_beside_ = 0;    // a door, on the way to this stop
  int arrival_failures_ = 0;
  int retries_ = 0;
  int failures_in_a_row_ = 0;
  int skipped_ = 0;
  Blockage blockage_;
  Polyline blocked_path_;                                 // that it leads through
  Eigen::Vector2d hold_place_ = Eigen::Vector2d::Zero();  // [m] world
  double blocker_distance_ = 0.0;                         // [m] from there to what blocked the way, then
  std::int64_t last_facing_ = 0;                          // [us] when the robot was last told to turn towards it
  std::string hold_reason_;
  Search search_;                  // for the stop at hand
  bool looks_at_gap_ = false;      // what it holds before is one
  double gap_limit_ = 0.0;         // [m] a way round it that is shorter is taken without the look, unknown counted more
  bool has_looked_again_ = false;  // at this blockage, from as near as can be
  double reference_length_ = 0.0;  // [m] of the way that was blocked
  std::int64_t hold_since_ = 0;    // [us] when the robot began to stand before the blockage; 0 = on its way there
};

}  // namespace luminav
