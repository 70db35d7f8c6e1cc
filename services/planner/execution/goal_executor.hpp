#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/planner/execution/goal_phase.hpp"
#include "services/planner/execution/goal_progress.hpp"
#include "services/planner/execution/people_in_the_way.hpp"
#include "services/planner/execution/pose_losses.hpp"
#include "services/planner/execution/search_effort.hpp"
#include "services/planner/goals/goal_types.hpp"
#include "services/planner/goals/issued_path.hpp"
#include "services/planner/goals/route_map.hpp"
#include "services/planner/goals/stop_list.hpp"
#include "services/planner/holding/blockage_hold.hpp"
#include "services/planner/holding/doubtful_start.hpp"
#include "services/planner/holding/gap_inspection.hpp"

namespace luminav {

/// Brings the robot to one stop after the other, and says in one sentence what it is doing. A state machine: see
/// `GoalPhase`. Every phase ends in bounded time, in ARRIVED or in a cause. Time comes in with each call.
class GoalExecutor {
 public:
  GoalExecutor(const GoalParams& params, const RoutePlannerParams& planner, std::vector<Door> doors);

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
  void map_changed(const OccupancyGrid& grid, int received, int tiles) { map_.change(grid, received, tiles); }
  /// Other zones are in force now: a robot under way stands until a path by these is found.
  void set_zones(const std::vector<Zone>& zones);
  void update(const Situation& situation);

  [[nodiscard]] bool is_active() const { return phase_ != GoalPhase::kNone; }
  [[nodiscard]] bool is_paused() const { return phase_ == GoalPhase::kPaused; }
  [[nodiscard]] const NavigationReport& report() const { return report_; }
  [[nodiscard]] const GoalPath& path() const { return path_.path(); }
  [[nodiscard]] int stop_index() const { return stops_.index(); }

 private:
  // between phases
  void enter(GoalPhase phase, NavigationState state, const std::string& cause);
  void plan_anew(const std::string& cause);
  void finish(NavigationState state, const std::string& cause);
  void fail_stop(NavigationState state, const std::string& cause);
  void reached_stop();
  void leave_stop();
  void next_stop();
  void reset_for_stop();
  void restart_clock(std::int64_t now);

  // kLocalizing
  [[nodiscard]] bool is_localized(const Situation& situation);
  /// False if the robot stands at its stop already.
  [[nodiscard]] bool found_place(const Situation& situation);
  void lose_place(const Situation& situation);
  void search_place(const Situation& situation);

  void update_at_place(const Situation& situation);

  // kPlanning, kSuspectingPlace
  void plan(const Situation& situation);
  [[nodiscard]] Route plan_route(const Situation& situation);
  [[nodiscard]] RouteRequest request_from(const Situation& situation) const;
  [[nodiscard]] std::string no_path(const Route& route) const;
  void wait_for_map();
  void handle_no_route(const Situation& situation, const Route& route);
  /// Doubts the pose rather than the goal. False when that has gone on for too long.
  [[nodiscard]] bool suspect_place(const Situation& situation);
  /// Drives to a gap that would make the path much shorter, or possible. False when there is none.
  [[nodiscard]] bool look_at_gap(const Situation& situation, const Route& route);
  void follow(const Route& route);

  // kHolding
  void hold(const Polyline& path, std::size_t blocked_at, double reference_length);
  void update_hold(const Situation& situation);
  /// No path leads on: looks again, gives up in the end, and meanwhile makes way and faces what blocks.
  void keep_holding(const Situation& situation, const Route& route);

  // kFollowing
  void update_following(const Situation& situation);
  void check_arrival(const Situation& situation);
  void check_path(const Situation& situation);
  void check_progress(const Situation& situation);
  void suspect_what_stops(const Situation& situation);
  void suspect_touched(const Situation& situation);
  void suspect(const SuspectedObstacle& obstacle, double seconds);

  void issue(const PathOrder& order) { path_.issue(order, stops_, now_); }
  [[nodiscard]] bool may_plan() const;

  GoalParams params_;
  RouteMap map_;
  StopList stops_;
  GoalPhase phase_ = GoalPhase::kNone;
  NavigationReport report_;
  std::optional<std::string> cause_before_;  // of the report, before the pose was lost for a moment
  IssuedPath path_;
  std::int64_t now_ = 0;          // [us]
  std::int64_t phase_since_ = 0;  // [us]
  std::int64_t last_plan_ = 0;    // [us] 0 = plan at once
  PoseLosses losses_;
  DoubtfulStart doubtful_start_;
  GoalProgress progress_;
  PeopleInTheWay people_;
  BlockageHold hold_;
  GapInspection gaps_;
  SearchEffort search_;
};

}  // namespace luminav
