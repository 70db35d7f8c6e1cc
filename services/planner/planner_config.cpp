#include "services/planner/planner_config.hpp"

#include <algorithm>
#include <utility>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

constexpr double kRadiusMargin = 0.0875;  // [m] between inscribed and hard radius: half a cell each for robot and wall

constexpr double kNewMapMargin = 0.0375;  // [m] the same on a map that is being drawn

void read_route(const TomlTable& table, const RobotDescription& robot, RoutePlannerParams& route) {
  const bool is_paper = table.choice("mode", robot.mode, {"paper", "modern"}) == "paper";
  route.mode = is_paper ? PlannerMode::kPaper : PlannerMode::kModern;
  ConfigurationSpaceParams& space = route.space;
  const double inscribed = robot.inscribed_radius();
  space.hard_radius = table.number("hard_radius", inscribed + kRadiusMargin, {inscribed, 1.2});
  table.read("clearance_range", space.clearance_range, {space.hard_radius + 0.01, 5.0});
  table.read("clearance_weight", space.clearance_weight, {0.0, ConfigurationSpace::kMaxDetour - 1.0});
  table.read("occupied_threshold", space.occupied_log_odds, {0.05, 6.0});
  table.read("free_threshold", space.free_log_odds, {-6.0, -0.05});
  space.unknown_is_free = table.choice("unknown", "blocked", {"blocked", "free"}) == "free";
  space.disputed_is_free = table.choice("disputed", "blocked", {"blocked", "free"}) == "free";
  table.read("escape_radius", route.escape_radius, {0.0, 3.0});
  route.shaping.keep_side = side_called(table.choice("keep_side", "none", {"none", "right", "left"}));
  route.body_radius = inscribed;
}

void read_goals(const TomlTable& table, GoalParams& goals) {
  table.read("tolerance", goals.tolerance, {0.02, 2.0});
  table.read("heading_tolerance", goals.heading_tolerance, {0.01, 3.2});
  table.read("tracking_grace", goals.tracking_grace, {0.0, 10.0});
  table.read("lost_timeout", goals.lost_timeout, {1.0, 3600.0});
  table.read("losses", goals.losses, {0, 1000});
  table.read("map_timeout", goals.map_timeout, {1.0, 600.0});
  table.read("blocked_wait", goals.blocked_wait, {0.0, 600.0});
  table.read("detour_ratio", goals.detour_ratio, {1.0, 100.0});
  table.read("detour_length", goals.detour_length, {0.0, 1000.0});
  table.read("replan_period", goals.replan_period, {0.05, 10.0});
  table.read("no_progress_time", goals.no_progress_time, {0.5, 120.0});
  table.read("search_ratio", goals.search_ratio, {1.0, 100.0});
  table.read("search_length", goals.search_length, {0.0, 10000.0});
  table.read("give_up_wait", goals.give_up_wait, {0.0, 3600.0});
  table.read("stuck_time", goals.stuck_time, {0.0, 3600.0});
  table.read("people_time", goals.people_time, {0.0, 3600.0});
  table.read("attempts", goals.attempts, {1, 100});
  table.read("retry_wait", goals.retry_wait, {0.0, 3600.0});
  table.read("retries", goals.retries, {0, 1000});
}

}  // namespace

void PlannerConfig::plan_on_a_new_map() {
  route.space.unknown_is_free = true;
  route.space.hard_radius = robot.inscribed_radius() + kNewMapMargin;
}

PlannerConfig read_planner_config(const std::filesystem::path& robot_file, const std::filesystem::path& building_file) {
  const TomlTable root = TomlTable::load(robot_file);
  PlannerConfig config;
  config.robot = read_robot(root);
  const TomlTable table = root.table("planner");
  read_route(table, config.robot, config.route);
  read_goals(table, config.goals);
  const auto front = std::max_element(config.robot.footprint.begin(), config.robot.footprint.end(),
                                      [](const auto& a, const auto& b) { return a.x() < b.x(); });
  config.goals.touch_ahead = front->x() + SuspectedObstacle{}.radius;
  table.reject_unknown();
  Building building = read_building(building_file);
  config.doors = std::move(building.doors);
  config.building = std::move(building.name);
  config.places = std::move(building.places);
  config.route.space.zones = std::move(building.zones);
  return config;
}

}  // namespace luminav
