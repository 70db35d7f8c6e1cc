#pragma once

#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/goal_t.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/common/building/zone_timetable.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/stamp_guard.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/planner/execution/goal_executor.hpp"
#include "services/planner/goals/goal_store.hpp"
#include "services/planner/planner_config.hpp"
#include "services/planner/space/tile_map.hpp"

namespace luminav {

/// GOAL in, PATH and NAVIGATION_STATUS out. POSE is the tick, ROBOT_STATUS where there is none.
class PlannerNode {
 public:
  /// With a key, commands without its seal are dropped.
  PlannerNode(lcm::LCM& lcm, const PlannerConfig& config, std::optional<CommandKey> key = {});

  /// Zones and places of the building are these from now on.
  void set_building(const Building& building);
  /// The planner is ended in order: a goal that is under way is kept, but asks before it goes on.
  void end();
  [[nodiscard]] Health health() const;
  /// What it listens to.
  [[nodiscard]] const std::vector<std::string>& channels() const { return subscriber_.channels(); }

 private:
  void on_goal(const goal_t& goal);
  void on_grid_tile(const grid_tile_t& tile);
  void on_pose(const pose_t& pose);
  void on_control_status(const control_status_t& status);
  void on_robot_status(const robot_status_t& status);

  void tick(std::int64_t utime);
  void act_on(const goal_t& goal, std::int64_t now);
  [[nodiscard]] std::string objection_to(const goal_t& goal) const;
  /// Points without a name are of any building.
  [[nodiscard]] bool is_of_this_building(const goal_pose_t& pose) const;
  [[nodiscard]] Situation situation(std::int64_t now) const;
  void request_tiles(std::int64_t now);
  void publish_path(std::int64_t now);
  void publish_status(std::int64_t now);
  void keep_goal();
  void keep(bool asks);
  void resume_stored_goal(std::int64_t now);

  lcm::LCM& lcm_;
  PlannerConfig config_;
  ZoneTimetable zones_;
  GoalExecutor executor_;
  GoalStore store_;
  TileMap map_;
  StampGuard pose_stamps_;
  StampGuard robot_stamps_;
  StampGuard control_stamps_;
  std::optional<pose_t> pose_;
  std::optional<robot_status_t> robot_;
  bool has_touched_ = false;  // something, forwards on its path, since the last tick
  std::optional<control_status_t> control_;
  std::int64_t control_heard_ = 0;      // [us] of our ticks
  std::int64_t now_ = 0;                // [us] newest stamp of POSE and ROBOT_STATUS
  std::deque<std::int64_t> done_ids_;   // requests acted on lately: repeats are no new requests
  std::optional<goal_t> waiting_goal_;  // came before any stamp of the robot
  goal_t accepted_;                     // as it came, for the store
  bool stored_goal_checked_ = false;
  std::int64_t last_request_ = 0;  // [us] TILE_REQUEST
  std::int64_t request_id_ = 0;
  std::int64_t last_status_ = 0;  // [us]
  std::int64_t last_path_ = 0;    // [us]
  int published_sequence_ = 0;
  NavigationState published_state_ = NavigationState::kIdle;
  std::int64_t published_goal_ = 0;
  std::optional<StoredGoal> kept_;  // as it lies in the store
  std::string store_error_;
  Subscriber subscriber_;  // last: no handler may run on a half-built node
};

}  // namespace luminav
