#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/hypotheses_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/path_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sonar_t.hpp>
#include <luminav/speed_limit_t.hpp>
#include <luminav/stop_t.hpp>
#include <luminav/teleop_command_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/common/building/zone_timetable.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/stamp_guard.hpp"
#include "services/common/process/stop_requests.hpp"
#include "services/common/process/subscriber.hpp"
#include "services/common/tiles/tile_map.hpp"
#include "services/controller/controller.hpp"
#include "services/controller/controller_config.hpp"
#include "services/controller/inputs/held_teleoperation.hpp"
#include "services/controller/inputs/obstacle_input.hpp"
#include "services/controller/inputs/pose_input.hpp"

namespace luminav {

/// The controller on the bus. The tick is ROBOT_STATUS (or ODOMETRY where that does not come): each is answered with a
/// VELOCITY_COMMAND, every second or third one with a fresh control step. While the robot moves, a POSE that a picture
/// has corrected is answered at once: by a new step for the newest tick, whose stamp the command bears.
class ControllerNode {
 public:
  /// With a key, commands without its seal are dropped.
  ControllerNode(lcm::LCM& lcm, const ControllerConfig& config, std::optional<CommandKey> key = {});

  /// The building's zones are these from now on.
  void set_zones(const std::vector<Zone>& zones);
  [[nodiscard]] Health health() const;
  /// What it listens to.
  [[nodiscard]] const std::vector<std::string>& channels() const { return subscriber_.channels(); }

 private:
  struct PlannerState {
    std::optional<navigation_status_t> newest;
    std::int64_t heard = 0;  // [us] newest tick when it came
  };
  /// VELOCITY_COMMAND's.
  struct CommandStream {
    std::int64_t session = 0;  // [us] of the first message answered
    std::int32_t sequence = 0;
  };
  struct Times {
    std::int64_t tick = 0;     // [us] newest
    std::int64_t control = 0;  // [us] last step
    std::int64_t status = 0;   // [us] last CONTROL_STATUS
  };

  void on_path(const path_t& message);
  void on_navigation_status(const navigation_status_t& message);
  void on_grid_tile(const grid_tile_t& message);
  void on_pose(const pose_t& message);
  void on_hypotheses(const hypotheses_t& message);
  void on_odometry(const odometry_t& message);
  void on_sonar(const sonar_t& message);
  void on_robot_status(const robot_status_t& message);
  void on_stop(const stop_t& message);
  void on_teleop_command(const teleop_command_t& message);
  void on_speed_limit(const speed_limit_t& message);

  void tick(std::int64_t utime);
  void control(std::int64_t utime);
  void publish_command(std::int64_t utime);
  void publish_status(std::int64_t utime);
  /// Remembers what blocks the wheels now, or presses a bumper, and did not before.
  void feel(const robot_status_t& status);

  [[nodiscard]] std::optional<PlacedGrid> placed_grid() const;
  [[nodiscard]] ControlInput input_at(std::int64_t utime);
  void choose_task(std::int64_t utime, ControlInput& input) const;
  [[nodiscard]] std::optional<std::string> reason_to_halt(std::int64_t utime) const;

  lcm::LCM& lcm_;
  ControllerConfig config_;
  CommandPublisher commands_;
  Subscriber subscriber_;
  ZoneTimetable zones_;
  Controller controller_;
  PoseInput pose_;
  ObstacleInput obstacles_;
  TileMap map_;
  PlannerState navigation_;
  StampGuard status_guard_;
  std::optional<robot_status_t> status_;
  HeldTeleoperation teleoperation_;
  HeldSpeedLimit speed_limit_;
  StopRequests stops_;

  CommandStream stream_;
  Times times_;
  std::int32_t status_sequence_ = 0;
  ControlOutput output_;
};

}  // namespace luminav
