#include "services/controller/controller_config.hpp"

#include <algorithm>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "services/controller/safety/footprint.hpp"

namespace luminav {

ControllerConfig ControllerConfig::for_robot(const RobotDescription& robot) {
  ControllerConfig config;
  config.robot = robot;
  config.follower.speed.linear = robot.limits.linear;
  config.follower.speed.angular = robot.limits.angular;
  config.follow_margin_and_speeds();
  return config;
}

void ControllerConfig::follow_margin_and_speeds() {
  wander.speed = std::min(wander.speed, follower.speed.linear);
  wander.angular = std::min(wander.angular, follower.speed.angular);
  double nose = 0.0;
  double half_width = 0.0;
  for (const Eigen::Vector2d& corner : robot.footprint) {
    nose = std::max(nose, corner.x());
    half_width = std::max(half_width, std::abs(corner.y()));
  }
  for (FreeHeadingParams* strip : {&follower.heading.free_heading, &wander.heading.free_heading}) {
    strip->nose = nose;
    strip->half_width = half_width + stop_logic.margin;
  }
  local_map.half_width = half_width + 0.01;
}

double ControllerConfig::view_radius() const {
  const CameraIntrinsics& lens = robot.camera.intrinsics;
  const double height = std::max(0.2, building.ceiling_height - robot.camera.mounting.z);
  return 1.2 * 0.5 * height * std::min(lens.width / lens.fx, lens.height / lens.fy);
}

ControllerConfig read_controller_config(const std::filesystem::path& robot_file,
                                        const std::filesystem::path& building_file) {
  const TomlTable root = TomlTable::load(robot_file);
  ControllerConfig config = ControllerConfig::for_robot(read_robot(root));
  const TomlTable table = root.table("controller");
  const MotionLimits& limits = config.robot.limits;
  SpeedLawParams& speed = config.follower.speed;
  table.read("maximum_linear", speed.linear, {0.02, limits.linear});
  table.read("maximum_angular", speed.angular, {0.02, limits.angular});
  table.read("turn_gain", speed.turn_gain, {0.2, 5.0});
  config.wander.speed = table.number("wander_speed", std::min(config.wander.speed, speed.linear), {0.02, speed.linear});
  table.read("look_ahead", config.follower.look_ahead.distance, {0.3, 3.0});
  table.read("arrival_radius", config.follower.arrival_radius, {0.005, 1.0});
  table.read("arrival_heading", config.follower.arrival_heading, {0.005, 1.0});
  table.read("force_influence", config.follower.forces.influence, {0.05, 2.0});
  table.read("force_strength", config.follower.forces.strength, {0.0, 10.0});
  table.read("margin", config.stop_logic.margin, {0.0, 0.5});
  table.read("known_margin", config.stop_logic.known_margin, {0.0, 0.5});
  table.read("bumper_linear", config.stop_logic.bumper_linear, {0.02, 0.5});
  table.read("time_to_contact", config.stop_logic.time_to_contact, {0.3, 5.0});
  table.read("echo_memory", config.echo_memory.keep, {0.4, 10.0});
  table.read("jerk", config.jerk, {0.1, 20.0});
  table.read("period", config.period, {0.02, 0.2});
  table.read("patience", config.patience, {0.5, 60.0});
  table.read("stuck_after", config.stuck_after, {1.0, 60.0});
  table.reject_unknown();
  config.follow_margin_and_speeds();
  if (!building_file.empty()) {
    config.building = read_building(building_file);
    config.walls = config.building.map_file.empty() ? PriorMap{} : resample(read_map(config.building.map_file), 0.1);
  }
  return config;
}

}  // namespace luminav
