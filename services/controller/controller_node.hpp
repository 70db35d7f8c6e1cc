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
#include "services/controller/controller.hpp"
#include "services/controller/controller_config.hpp"
#include "services/controller/recent_odometry.hpp"
#include "services/controller/safety/sonar_watch.hpp"
#include "services/controller/safety/touch_memory.hpp"

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
  void restart_odometry(const odometry_t& first);
  /// What the building's map leads a disc of a robot that stands there to expect.
  [[nodiscard]] SonarWatch::Place look_at_map(std::size_t disc, const Pose2& world_from_robot) const;
  /// Remembers what blocks the wheels now, or presses a bumper, and did not before.
  void feel(const robot_status_t& status);

  [[nodiscard]] ControlInput input_at(std::int64_t utime);
  void choose_task(std::int64_t utime, ControlInput& input) const;
  [[nodiscard]] std::optional<std::string> reason_to_halt(std::int64_t utime) const;
  [[nodiscard]] std::optional<std::string> reason_not_to_trust_pose() const;
  [[nodiscard]] std::optional<Pose2> world_from_odom() const;
  /// Where the robot may be, while its pose is not known.
  [[nodiscard]] std::vector<PoseAlternative> possible_poses() const;

  lcm::LCM& lcm_;
  ControllerConfig config_;
  CommandPublisher commands_;
  Subscriber subscriber_;
  ZoneTimetable zones_;
  Controller controller_;
  EchoMemory echoes_;
  SonarWatch sonar_watch_;
  TouchMemory touches_;
  OccupancyGrid grid_;
  std::int64_t map_session_ = 0;
  bool has_grid_ = false;

  StampGuard odometry_guard_;
  StampGuard status_guard_;
  RecentOdometry odometry_;
  std::optional<pose_t> pose_;
  std::vector<PoseAlternative> alternatives_;   // of the newest HYPOTHESES
  std::optional<Pose2> known_world_from_odom_;  // when it was known last
  std::optional<navigation_status_t> navigation_;
  std::int64_t navigation_heard_ = 0;  // [us] newest tick when it came
  std::optional<robot_status_t> status_;
  std::optional<teleop_command_t> teleop_;
  std::int64_t teleop_until_ = 0;  // [us] a person drove until then
  HeldSpeedLimit speed_limit_;
  StopRequests stops_;

  std::int64_t session_ = 0;  // [us] of the first message answered
  std::int32_t command_sequence_ = 0;
  std::int32_t status_sequence_ = 0;
  std::int64_t newest_tick_ = 0;     // [us]
  std::int64_t last_control_ = 0;    // [us]
  std::int64_t last_published_ = 0;  // [us] CONTROL_STATUS
  ControlOutput output_;
};

}  // namespace luminav
