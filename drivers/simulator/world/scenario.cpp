#include "drivers/simulator/world/scenario.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_base.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

constexpr Range kCoordinate{-1e5, 1e5};  // [m]
constexpr Range kHeading{-7.0, 7.0};     // [rad] a full turn either way is accepted and wrapped
constexpr Range kDuration{0.0, 1e7};     // [s]

double read_theta(const TomlTable& table) {
  return wrap_angle(table.number("theta", 0.0, kHeading));
}

/// Both coordinates or none.
bool has_position(const TomlTable& table) {
  const bool has_x = table.has("x");
  const bool has_y = table.has("y");
  if (has_x != has_y) {
    table.fail(has_x ? "y" : "x", "is missing, must be given with the other coordinate [m]");
  }
  return has_x;
}

void check_fixture(const TomlTable& table, std::string_view key, int id, const Building& building) {
  const auto has_id = [id](const Fixture& fixture) { return fixture.id == id; };
  if (std::none_of(building.fixtures.begin(), building.fixtures.end(), has_id)) {
    table.fail(key, fmt::format("names fixture {}, must be one of the building's ids", id));
  }
}

std::vector<int> read_fixtures(const TomlTable& table, std::string_view key, const Building& building) {
  const std::vector<int> ids = table.integers(key);
  for (const int id : ids) {
    check_fixture(table, key, id, building);
  }
  return ids;
}

LightingPlan read_lighting(const TomlTable& table, const Building& building) {
  LightingPlan lighting;
  lighting.daylight = table.number("daylight", lighting.daylight, kFraction);
  lighting.off = read_fixtures(table, "off", building);
  lighting.half = read_fixtures(table, "half", building);
  lighting.flicker = read_fixtures(table, "flicker", building);
  lighting.off_ratio = table.number("off_ratio", lighting.off_ratio, kFraction);
  table.reject_unknown();
  return lighting;
}

WorldSpread read_spread(const TomlTable& table) {
  WorldSpread spread;
  const auto read = [&table](std::string_view key, double& value, double max) {
    value = table.number(key, value, {0.0, max});
  };
  spread.calibrated = table.boolean("calibrated", spread.calibrated);
  read("wheel_scale", spread.wheel_scale, 0.2);
  read("wheel_ratio", spread.wheel_ratio, 0.2);
  read("wheel_base", spread.wheel_base, 0.2);
  read("odometry_position", spread.odometry_position, 1.0);
  read("odometry_heading", spread.odometry_heading, 1.0);
  read("camera_tilt", spread.camera_tilt, 0.3);
  read("camera_yaw", spread.camera_yaw, 0.3);
  read("camera_height", spread.camera_height, 0.3);
  read("time_offset", spread.time_offset, 0.5);
  read("row_time", spread.row_time, 0.1);
  read("residual_k1", spread.residual_k1, 0.2);
  read("fixture_position", spread.fixture_position, 1.0);
  read("fixture_heading", spread.fixture_heading, 0.5);
  read("ceiling_height", spread.ceiling_height, 0.2);
  read("floor_tilt", spread.floor_tilt, 0.1);
  read("min_unlit_darker", spread.min_unlit_darker, 255.0);
  read("max_unlit_darker", spread.max_unlit_darker, 255.0);
  read("grey_noise", spread.grey_noise, 100.0);
  for (const std::string& name : table.texts("luminaires")) {
    const auto kind = luminaire_named(name);
    if (!kind) {
      table.fail("luminaires", fmt::format("names \"{}\", must be of {}", name, fmt::join(luminaire_names(), ", ")));
    }
    spread.luminaires.push_back(*kind);
  }
  if (spread.max_unlit_darker < spread.min_unlit_darker) {
    table.fail("max_unlit_darker", "must not be below min_unlit_darker");
  }
  table.reject_unknown();
  return spread;
}

Obstacle read_obstacle(const TomlTable& table) {
  Obstacle obstacle;
  const double theta = read_theta(table);
  if (has_position(table)) {
    obstacle.world_from_obstacle = Pose2{table.number("x", kCoordinate), table.number("y", kCoordinate), theta};
  } else if (table.has("theta")) {
    table.fail("theta", "needs x and y; without them place and heading are drawn");
  }
  obstacle.length = table.number("length", obstacle.length, {0.02, 20.0});
  obstacle.width = table.number("width", obstacle.width, {0.02, 20.0});
  const std::string kind = table.choice("kind", "box", {"box", "legs", "glass", "table"});
  obstacle.kind = kind == "legs"    ? ObstacleKind::kLegs
                  : kind == "glass" ? ObstacleKind::kGlass
                  : kind == "table" ? ObstacleKind::kTable
                                    : ObstacleKind::kBox;
  table.reject_unknown();
  return obstacle;
}

WalkingPerson read_person(const TomlTable& table) {
  WalkingPerson person;
  person.waypoints = table.points("waypoints");
  if (table.has("waypoints") && person.waypoints.size() < 2) {
    table.fail("waypoints", "must have at least two points; leave it out to have them drawn");
  }
  person.speed = table.number("speed", person.speed, {0.0, 3.0});
  table.reject_unknown();
  return person;
}

const Place& find_place(const TomlTable& table, const std::string& name, const Building& building) {
  const auto is_named = [&name](const Place& place) { return place.name == name; };
  const auto found = std::find_if(building.places.begin(), building.places.end(), is_named);
  if (found == building.places.end()) {
    table.fail("place", fmt::format("= \"{}\", must be the name of one of the building's places", name));
  }
  return *found;
}

Dock read_dock(const TomlTable& table, const Building& building) {
  Dock dock;
  dock.place = table.text("place");
  const Place& place = find_place(table, dock.place, building);
  if (!place.has_theta) {
    table.fail("place", fmt::format("= \"{}\", must be a place with a heading", dock.place));
  }
  dock.pose = place.pose;
  dock.reach = table.number("reach", dock.reach, {0.01, 1.0});
  dock.heading = table.number("heading", dock.heading, {0.01, 3.2});
  dock.contact = table.number("contact", dock.contact, kFraction);
  table.reject_unknown();
  return dock;
}

JobPlan read_jobs(const TomlTable& table) {
  JobPlan plan;
  plan.count = static_cast<int>(table.integer("count", 0, {0.0, 1000.0}));
  plan.time = table.number("time", plan.time, kDuration);
  plan.kills = static_cast<int>(table.integer("kills", 0, {0.0, 1000.0}));
  plan.only_guides = table.choice("kinds", "all", {"all", "guides"}) == "guides";
  table.reject_unknown();
  return plan;
}

ScenarioGoal read_goal(const TomlTable& table, const Building& building) {
  ScenarioGoal goal;
  goal.place = table.text("place", "");
  goal.has_theta = table.has("theta");
  if (goal.place.empty()) {
    goal.pose.x = table.number("x", kCoordinate);
    goal.pose.y = table.number("y", kCoordinate);
  } else {
    if (has_position(table)) {
      table.fail("place", "must not stand beside x and y");
    }
    const Place& place = find_place(table, goal.place, building);
    goal.pose = place.pose;
    goal.has_theta = goal.has_theta || place.has_theta;
  }
  if (table.has("theta")) {
    goal.pose.theta = read_theta(table);
  }
  goal.expect_refused = table.choice("expect", "reached", {"reached", "refused"}) == "refused";
  goal.tolerance = table.number("tolerance", goal.tolerance, {0.01, 100.0});
  table.reject_unknown();
  return goal;
}

DriveStep read_drive(const TomlTable& table) {
  DriveStep step;
  step.linear = table.number("v", 0.0, {-3.0, 3.0});
  step.angular = table.number("w", 0.0, {-6.0, 6.0});
  step.duration = table.number("for", kDuration);
  table.reject_unknown();
  return step;
}

Pose2 read_displacement(const TomlTable& table) {
  return {table.number("dx", 0.0, {-100.0, 100.0}), table.number("dy", 0.0, {-100.0, 100.0}),
          wrap_angle(table.number("dtheta", 0.0, kHeading))};
}

void read_light_event(const TomlTable& table, const Building& building, ScenarioEvent& event) {
  if (table.has("daylight")) {
    event.daylight = table.number("daylight", kFraction);
  }
  event.on = read_fixtures(table, "on", building);
  event.off = read_fixtures(table, "off", building);
}

void read_door_event(const TomlTable& table, const Building& building, ScenarioEvent& event) {
  event.id = static_cast<int>(table.integer("id", {0, 1e9}));
  if (!table.has("open")) {
    table.fail("open", "is missing, must be true or false");
  }
  event.open = table.boolean("open", true);
  const auto has_id = [&event](const Door& door) { return door.id == event.id; };
  if (std::none_of(building.doors.begin(), building.doors.end(), has_id)) {
    table.fail("id", fmt::format("= {}, must be the id of one of the building's doors", event.id));
  }
}

void read_carry_event(const TomlTable& table, ScenarioEvent& event) {
  event.has_place = has_position(table);
  if (event.has_place) {
    event.pose = {table.number("x", kCoordinate), table.number("y", kCoordinate), read_theta(table)};
  } else if (table.has("theta")) {
    table.fail("theta", "needs x and y; without them place and heading are drawn");
  }
  event.duration = table.number("duration", 3.0, kDuration);
}

void read_dead_sense(const TomlTable& table, const std::string& kind, ScenarioEvent& event) {
  event.kind = kind == "deafen"   ? EventKind::kDeafen
               : kind == "stick"  ? EventKind::kStick
               : kind == "freeze" ? EventKind::kFreeze
                                  : EventKind::kCover;
  event.duration = table.number("duration", kDuration.max, kDuration);
  if (kind == "freeze") {
    (void)table.text("device");  // required
    event.device = table.choice("device", "", {"camera", "encoder_left", "encoder_right"});
  } else if (kind != "cover") {
    event.discs = table.integers("discs");
    if (std::any_of(event.discs.begin(), event.discs.end(), [](int disc) { return disc < 0 || disc > 31; })) {
      table.fail("discs", "must be numbers of sonar discs, from 0");
    }
  }
}

ScenarioEvent read_event(const TomlTable& table, const Building& building) {
  ScenarioEvent event;
  event.at = table.number("at", kDuration);
  (void)table.text("kind");  // required
  const std::string kind = table.choice("kind", "",
                                        {"carry", "slip", "bump", "light", "door", "unplug", "lamp", "deafen", "stick",
                                         "freeze", "cover", "kill", "clock"});
  if (kind == "carry") {
    event.kind = EventKind::kCarry;
    read_carry_event(table, event);
  } else if (kind == "slip") {
    event.kind = EventKind::kSlip;
    event.factor = table.number("factor", {0.0, 2.0});
    event.duration = table.number("duration", kDuration);
  } else if (kind == "bump") {
    event.kind = EventKind::kBump;
    event.pose = read_displacement(table);
  } else if (kind == "light") {
    event.kind = EventKind::kLight;
    read_light_event(table, building, event);
  } else if (kind == "door") {
    event.kind = EventKind::kDoor;
    read_door_event(table, building, event);
  } else if (kind == "unplug") {
    event.kind = EventKind::kUnplug;
    (void)table.text("device");  // required
    event.device = table.choice("device", "", {"camera", "serial"});
    event.duration = table.number("duration", kDuration);
  } else if (kind == "lamp") {
    event.kind = EventKind::kLamp;
    event.id = static_cast<int>(table.integer("id", {0, 1e9}));
    check_fixture(table, "id", event.id, building);
    event.pose = read_displacement(table);
  } else if (kind == "deafen" || kind == "stick" || kind == "freeze" || kind == "cover") {
    read_dead_sense(table, kind, event);
  } else if (kind == "kill") {
    event.kind = EventKind::kKill;
    (void)table.text("process");  // required
    event.process = table.choice(
        "process", "", {"p3dx", "create2", "camera", "detector", "localizer", "mapper", "planner", "controller"});
  } else {
    event.kind = EventKind::kClock;
    event.host = table.text("host", "");
    event.step = table.number("step", {-1e9, 1e9});
  }
  table.reject_unknown();
  return event;
}

Hole read_hole(const TomlTable& table) {
  Hole hole;
  hole.pose = {table.number("x", kCoordinate), table.number("y", kCoordinate), read_theta(table)};
  hole.length = table.number("length", hole.length, kPositive);
  hole.width = table.number("width", hole.width, kPositive);
  table.reject_unknown();
  return hole;
}

void read_start(const TomlTable& table, Scenario& scenario) {
  const double theta = read_theta(table);
  if (has_position(table)) {
    scenario.start = Pose2{table.number("x", kCoordinate), table.number("y", kCoordinate), theta};
  } else if (table.has("theta")) {
    table.fail("theta", "needs x and y; without them place and heading are drawn");
  }
  scenario.start_known = table.boolean("known", scenario.start_known);
  table.reject_unknown();
}

std::filesystem::path read_file_name(const TomlTable& root, std::string_view key) {
  (void)root.text(key);  // required
  return root.path(key);
}

std::filesystem::path read_true_building(const TomlTable& table, const std::filesystem::path& believed) {
  const std::filesystem::path file = table.path("building");
  if (!file.empty() && !std::filesystem::is_regular_file(file)) {
    table.fail("building", fmt::format("= \"{}\": no such file", file.string()));
  }
  table.reject_unknown();
  return file.empty() ? believed : file;
}

}  // namespace

Scenario read_scenario(const std::filesystem::path& file) {
  const TomlTable root = TomlTable::load(file);
  Scenario scenario;
  scenario.file = root.file();
  scenario.name = scenario.file.stem().string();
  scenario.building_file = read_file_name(root, "building");
  scenario.robot_file = read_file_name(root, "robot");
  scenario.seed = static_cast<std::uint64_t>(root.integer("seed", 1, {0.0, 9e15}));
  scenario.duration = root.number("duration", scenario.duration, kPositive);
  for (const char* key : {"building", "robot"}) {
    if (!std::filesystem::is_regular_file(root.path(key))) {
      root.fail(key, fmt::format("= \"{}\": no such file", root.path(key)));
    }
  }
  scenario.base = read_robot_base(scenario.robot_file);
  scenario.true_building_file = read_true_building(root.table("truth"), scenario.building_file);
  const Building building = read_building(scenario.building_file);
  const Building true_building = read_building(scenario.true_building_file);
  read_start(root.table("start"), scenario);
  scenario.lighting = read_lighting(root.table("lighting"), true_building);
  scenario.world = read_spread(root.table("world"));
  for (const TomlTable& table : root.tables("obstacle")) {
    scenario.obstacles.push_back(read_obstacle(table));
  }
  for (const TomlTable& table : root.tables("person")) {
    scenario.people.push_back(read_person(table));
  }
  for (const TomlTable& table : root.tables("hole")) {
    scenario.holes.push_back(read_hole(table));
  }
  if (root.has("dock")) {
    scenario.dock = read_dock(root.table("dock"), building);
  }
  const TomlTable battery = root.table("battery");
  scenario.battery_voltage = battery.number("voltage", scenario.battery_voltage, {11.0, 12.9});
  battery.reject_unknown();
  scenario.jobs = read_jobs(root.table("jobs"));
  for (const TomlTable& table : root.tables("goal")) {
    scenario.goals.push_back(read_goal(table, building));
  }
  for (const TomlTable& table : root.tables("drive")) {
    scenario.drives.push_back(read_drive(table));
  }
  for (const TomlTable& table : root.tables("event")) {
    scenario.events.push_back(read_event(table, true_building));
  }
  root.reject_unknown();
  return scenario;
}

}  // namespace luminav
