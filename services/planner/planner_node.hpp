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
#include "services/common/process/subscriber.hpp"
#include "services/common/tiles/tile_map.hpp"
#include "services/planner/execution/goal_executor.hpp"
#include "services/planner/goals/goal_keeper.hpp"
#include "services/planner/planner_config.hpp"
#include "services/planner/situation_input.hpp"

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
  struct TileRequests {
    std::int64_t last = 0;  // [us]
    std::int64_t id = 0;
  };
  /// What was said last, and when [us].
  struct Published {
    std::int64_t path_at = 0;
    int path_sequence = 0;
    std::int64_t status_at = 0;
    NavigationState state = NavigationState::kIdle;
    std::int64_t goal_id = 0;
  };

  void on_goal(const goal_t& goal);
  void on_grid_tile(const grid_tile_t& tile);
  void on_pose(const pose_t& pose);
  void on_control_status(const control_status_t& status);
  void on_robot_status(const robot_status_t& status);

  void heed(const SituationInput::Verdict& verdict, std::int64_t utime);
  void tick(std::int64_t utime);
  void act_on(const goal_t& goal, std::int64_t now);
  [[nodiscard]] std::string objection_to(const goal_t& goal) const;
  /// Points without a name are of any building.
  [[nodiscard]] bool is_of_this_building(const goal_pose_t& pose) const;
  [[nodiscard]] GoalProgressNow progress() const;
  void request_tiles(std::int64_t now);
  void publish_path(std::int64_t now);
  void publish_status(std::int64_t now);
  void resume_stored_goal(std::int64_t now);

  lcm::LCM& lcm_;
  PlannerConfig config_;
  ZoneTimetable zones_;
  GoalExecutor executor_;
  GoalKeeper keeper_;
  TileMap map_;
  TileRequests tile_requests_;
  SituationInput situation_;
  std::int64_t now_ = 0;                // [us] newest stamp of POSE and ROBOT_STATUS
  std::deque<std::int64_t> done_ids_;   // requests acted on lately: repeats are no new requests
  std::optional<goal_t> waiting_goal_;  // came before any stamp of the robot
  bool stored_goal_checked_ = false;
  Published published_;
  Subscriber subscriber_;  // last: no handler may run on a half-built node
};

}  // namespace luminav
