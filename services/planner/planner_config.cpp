#include "services/planner/planner_config.hpp"

#include <utility>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

constexpr double kRadiusMargin = 0.0875;  // [m] between inscribed and hard radius: half a cell each for robot and wall

void read_route(const TomlTable& table, const RobotDescription& robot, RoutePlannerParams& route) {
  const bool is_paper = table.choice("mode", robot.mode, {"paper", "modern"}) == "paper";
  route.mode = is_paper ? PlannerMode::kPaper : PlannerMode::kModern;
  ConfigurationSpaceParams& space = route.space;
  const double inscribed = robot.inscribed_radius();
  space.hard_radius = table.number("hard_radius", inscribed + kRadiusMargin, {inscribed, 1.2});
  space.clearance_range = table.number("clearance_range", space.clearance_range, {space.hard_radius + 0.01, 5.0});
  space.clearance_weight = table.number("clearance_weight", space.clearance_weight, {0.0, 8.0});
  space.occupied_log_odds = table.number("occupied_threshold", space.occupied_log_odds, {0.05, 6.0});
  space.free_log_odds = table.number("free_threshold", space.free_log_odds, {-6.0, -0.05});
  space.unknown_is_free = table.choice("unknown", "blocked", {"blocked", "free"}) == "free";
  space.disputed_is_free = table.choice("disputed", "blocked", {"blocked", "free"}) == "free";
  route.escape_radius = table.number("escape_radius", route.escape_radius, {0.0, 3.0});
  route.body_radius = inscribed;
}

void read_cycle(const TomlTable& table, GoalCycleParams& cycle) {
  cycle.tolerance = table.number("tolerance", cycle.tolerance, {0.02, 2.0});
  cycle.heading_tolerance = table.number("heading_tolerance", cycle.heading_tolerance, {0.01, 3.2});
  cycle.tracking_grace = table.number("tracking_grace", cycle.tracking_grace, {0.0, 10.0});
  cycle.lost_timeout = table.number("lost_timeout", cycle.lost_timeout, {1.0, 3600.0});
  cycle.losses = table.count("losses", cycle.losses, {0, 1000});
  cycle.map_timeout = table.number("map_timeout", cycle.map_timeout, {1.0, 600.0});
  cycle.blocked_wait = table.number("blocked_wait", cycle.blocked_wait, {0.0, 600.0});
  cycle.detour_ratio = table.number("detour_ratio", cycle.detour_ratio, {1.0, 100.0});
  cycle.detour_length = table.number("detour_length", cycle.detour_length, {0.0, 1000.0});
  cycle.replan_period = table.number("replan_period", cycle.replan_period, {0.05, 10.0});
  cycle.no_progress_time = table.number("no_progress_time", cycle.no_progress_time, {0.5, 120.0});
  cycle.search_length = table.number("search_length", cycle.search_length, {0.0, 10000.0});
  cycle.give_up_wait = table.number("give_up_wait", cycle.give_up_wait, {0.0, 3600.0});
  cycle.stuck_time = table.number("stuck_time", cycle.stuck_time, {0.0, 3600.0});
  cycle.people_time = table.number("people_time", cycle.people_time, {0.0, 3600.0});
  cycle.attempts = table.count("attempts", cycle.attempts, {1, 100});
  cycle.retry_wait = table.number("retry_wait", cycle.retry_wait, {0.0, 3600.0});
  cycle.retries = table.count("retries", cycle.retries, {0, 1000});
}

}  // namespace

PlannerConfig read_planner_config(const std::filesystem::path& robot_file, const std::filesystem::path& building_file) {
  const TomlTable root = TomlTable::load(robot_file);
  PlannerConfig config;
  config.robot = read_robot(root);
  const TomlTable table = root.table("planner");
  read_route(table, config.robot, config.route);
  read_cycle(table, config.cycle);
  table.reject_unknown();
  Building building = read_building(building_file);
  config.doors = std::move(building.doors);
  config.building = std::move(building.name);
  config.places = std::move(building.places);
  for (Zone& zone : building.zones) {
    if (zone.kind == ZoneKind::kKeepOut) {
      config.route.space.keep_out.push_back(zone.polygon);
      config.keep_out.push_back(std::move(zone));
    }
  }
  return config;
}

}  // namespace luminav
