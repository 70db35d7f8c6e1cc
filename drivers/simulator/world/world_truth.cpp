#include "drivers/simulator/world/world_truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "drivers/simulator/geometry/random_stream.hpp"
#include "drivers/simulator/geometry/shapes.hpp"
#include "drivers/simulator/world/free_space.hpp"
#include "drivers/simulator/world/lamp_state.hpp"
#include "drivers/simulator/world/obstacle_placement.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kStartClearance = 0.45;   // [m] of a random place to stand to everything that is not free
constexpr double kFromObstacles = 0.6;     // [m] of a random place to stand to obstacles with a given place
constexpr double kPersonClearance = 0.35;  // [m] of a drawn person's path to everything
constexpr double kPersonPath = 3.0;        // [m] at least, of a drawn person
constexpr double kPersonFromStart = 1.0;   // [m] between a drawn person and the robot when the run begins
constexpr int kTries = 5000;

[[noreturn]] void fail(const Scenario& scenario, const std::string& message) {
  throw ConfigurationError(fmt::format("{}: {}", scenario.file.empty() ? "scenario" : scenario.file.string(), message));
}

/// "calibrated": what a careful user has measured is known ten times better.
WorldSpread effective_spread(WorldSpread spread) {
  if (!spread.calibrated) {
    return spread;
  }
  for (double* constant : {&spread.wheel_scale, &spread.wheel_ratio, &spread.wheel_base, &spread.camera_tilt,
                           &spread.camera_yaw, &spread.camera_height, &spread.time_offset, &spread.residual_k1}) {
    *constant *= 0.1;
  }
  spread.fixture_position = std::min(spread.fixture_position, 0.003);
  spread.fixture_heading = std::min(spread.fixture_heading, radians(0.2));
  return spread;
}

/// Collects the lines of the world's table.
class Table {
 public:
  void add(std::string_view name, std::string_view unit, double spread, double drawn) {
    text += fmt::format("{:<20} 1 sigma {:>9.5f}  drawn {:>9.5f}  {}\n", name, spread, drawn, unit);
  }
  void add(std::string_view name, std::string_view unit, double value) {
    text += fmt::format("{:<20} value   {:>9.5f}  {}\n", name, value, unit);
  }
  std::string text;
};

std::string hash_of(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  for (const char letter : text) {
    hash = (hash ^ static_cast<unsigned char>(letter)) * 0x100000001b3ULL;
  }
  return fmt::format("{:016x}", hash);
}

void draw_wheels(const Scenario& scenario, const WorldSpread& spread, WorldTruth& truth, Table& table) {
  RandomStream random(scenario.seed, "wheels");
  const double scale = random.gaussian(spread.wheel_scale);
  const double ratio = random.gaussian(spread.wheel_ratio);
  const double base = random.gaussian(spread.wheel_base);
  truth.wheels.scale_left = (1.0 + scale) * (1.0 - 0.5 * ratio);
  truth.wheels.scale_right = (1.0 + scale) * (1.0 + 0.5 * ratio);
  truth.wheels.believed_base = truth.robot.wheel_base;
  truth.robot.wheel_base *= 1.0 + base;
  truth.wheels.noise_position = spread.odometry_position;
  truth.wheels.noise_heading = spread.odometry_heading;
  table.add("wheel_scale", "", spread.wheel_scale, scale);
  table.add("wheel_ratio", "right over left", spread.wheel_ratio, ratio);
  table.add("wheel_base", "", spread.wheel_base, base);
  table.add("odometry_position", "m per sqrt m", spread.odometry_position);
  table.add("odometry_heading", "rad per sqrt m", spread.odometry_heading);
}

void draw_camera(const Scenario& scenario, const WorldSpread& spread, WorldTruth& truth, Table& table) {
  RandomStream random(scenario.seed, "camera");
  CameraDescription& camera = truth.robot.camera;
  const double roll = random.gaussian(spread.camera_tilt);
  const double pitch = random.gaussian(spread.camera_tilt);
  const double yaw = random.gaussian(spread.camera_yaw);
  const double height = random.gaussian(spread.camera_height);
  const double offset = random.gaussian(spread.time_offset);
  const double k1 = random.gaussian(spread.residual_k1);
  camera.mounting.roll += roll;
  camera.mounting.pitch += pitch;
  camera.mounting.yaw = wrap_angle(camera.mounting.yaw + yaw);
  camera.mounting.z *= 1.0 + height;
  camera.time_offset += offset;
  camera.intrinsics.distortion[0] += k1;
  camera.row_time = spread.row_time / camera.intrinsics.height;
  table.add("camera_tilt (roll)", "rad", spread.camera_tilt, roll);
  table.add("camera_tilt (pitch)", "rad", spread.camera_tilt, pitch);
  table.add("camera_yaw", "rad", spread.camera_yaw, yaw);
  table.add("camera_height", "", spread.camera_height, height);
  table.add("time_offset", "s", spread.time_offset, offset);
  table.add("row_time", "s per frame", spread.row_time);
  table.add("residual_k1", "", spread.residual_k1, k1);
}

Pose2 draw_displaced(const Pose2& believed, const WorldSpread& spread, RandomStream& random) {
  const double dx = random.gaussian(spread.fixture_position);
  const double dy = random.gaussian(spread.fixture_position);
  return {believed.x + dx, believed.y + dy, wrap_angle(believed.theta + random.gaussian(spread.fixture_heading))};
}

void draw_ceiling(const Scenario& scenario, const WorldSpread& spread, WorldTruth& truth, Table& table) {
  RandomStream random(scenario.seed, "ceiling");
  const double height = random.gaussian(spread.ceiling_height);
  truth.building.ceiling_height *= 1.0 + height;
  double squares = 0.0;
  for (Fixture& fixture : truth.building.fixtures) {
    RandomStream own(scenario.seed, "fixture", static_cast<std::uint64_t>(fixture.id));
    const Pose2 believed = fixture.world_from_fixture;
    fixture.world_from_fixture = draw_displaced(believed, spread, own);
    fixture.height *= 1.0 + height;
    squares += std::pow(distance(believed, fixture.world_from_fixture), 2);
    truth.unlit_darker.push_back(own.uniform(spread.min_unlit_darker, spread.max_unlit_darker));
  }
  for (std::size_t i = 0; i < truth.building.elements.size(); ++i) {
    RandomStream own(scenario.seed, "element", i);
    CeilingElement& element = truth.building.elements[i];
    element.world_from_element = draw_displaced(element.world_from_element, spread, own);
  }
  truth.luminaires = draw_luminaires(spread.luminaires, truth.building, scenario.seed);
  const auto count = static_cast<double>(std::max<std::size_t>(1, truth.building.fixtures.size()));
  truth.floor_tilt = spread.floor_tilt;
  truth.grey_noise = spread.grey_noise;
  table.add("ceiling_height", "", spread.ceiling_height, height);
  table.add("fixture_position", "m per axis, root mean square", spread.fixture_position,
            std::sqrt(squares / (2.0 * count)));
  table.add("fixture_heading", "rad", spread.fixture_heading);
  table.add("floor_tilt", "rad per axis, every metre", spread.floor_tilt);
  table.add("min_unlit_darker", "grey levels", spread.min_unlit_darker);
  table.add("max_unlit_darker", "grey levels", spread.max_unlit_darker);
  table.add("grey_noise", "grey levels", spread.grey_noise);
  for (const LuminaireKind kind : spread.luminaires) {
    table.add("luminaires: " + luminaire_names()[static_cast<std::size_t>(kind)], "fixtures",
              static_cast<double>(std::count(truth.luminaires.begin(), truth.luminaires.end(), kind)));
  }
}

std::size_t index_of_fixture(const Scenario& scenario, const Building& building, int id) {
  for (std::size_t i = 0; i < building.fixtures.size(); ++i) {
    if (building.fixtures[i].id == id) {
      return i;
    }
  }
  fail(scenario, fmt::format("the building has no fixture {}", id));
}

void draw_lighting(const Scenario& scenario, WorldTruth& truth, Table& table) {
  const LightingPlan& plan = scenario.lighting;
  const std::vector<Fixture>& fixtures = truth.building.fixtures;
  truth.daylight = plan.daylight;
  truth.lamp_states.assign(fixtures.size(), kLampOn);
  // the same fixtures go first whatever the ratio
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < fixtures.size(); ++i) {
    order.emplace_back(RandomStream(scenario.seed, "lamp", static_cast<std::uint64_t>(fixtures[i].id)).uniform(), i);
  }
  std::sort(order.begin(), order.end());
  const auto off = static_cast<std::size_t>(std::lround(plan.off_ratio * static_cast<double>(fixtures.size())));
  for (std::size_t i = 0; i < off; ++i) {
    truth.lamp_states[order[i].second] = kLampOff;
  }
  const auto set = [&](const std::vector<int>& ids, std::int8_t state) {
    for (const int id : ids) {
      truth.lamp_states[index_of_fixture(scenario, truth.building, id)] = state;
    }
  };
  set(plan.off, kLampOff);
  set(plan.half, kLampHalf);
  set(plan.flicker, kLampFlicker);
  table.add("daylight", "0..1", plan.daylight);
  table.add("lamps off", "",
            static_cast<double>(std::count(truth.lamp_states.begin(), truth.lamp_states.end(), kLampOff)));
}

bool overlaps_wall(const PriorMap& walls, const Polygon& outline) {
  const double half = 0.5 * walls.geometry.resolution;
  const Polygon cell_shape{{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  for (int row = 0; row < walls.geometry.rows; ++row) {
    for (int column = 0; column < walls.geometry.columns; ++column) {
      if (walls.cells[walls.geometry.index({column, row})] != Prior::kOccupied) {
        continue;
      }
      const Vector2d centre = walls.geometry.centre_of({column, row});
      if ((centre - outline.front()).norm() < 3.0 &&
          distance(outline, transform({centre.x(), centre.y(), 0.0}, cell_shape)) <= 0.0) {
        return true;
      }
    }
  }
  return false;
}

/// Draws what depends on the building's map; the map is searched only when something is random.
class Placement {
 public:
  Placement(const Scenario& scenario, WorldTruth& truth) : scenario_(scenario), truth_(truth) {}

  void run() {
    given_ = truth_.holes;
    for (const Obstacle& obstacle : scenario_.obstacles) {
      if (obstacle.world_from_obstacle) {
        given_.push_back(rectangle(*obstacle.world_from_obstacle, obstacle.length, obstacle.width));
      }
    }
    place_start();
    place_carries();
    place_obstacles();
    place_people();
    check_events();
  }

 private:
  const FreeSpace& space() {
    if (!space_) {
      space_.emplace(truth_.walls);
    }
    return *space_;
  }

  void place_start() {
    if (scenario_.start) {
      truth_.start = *scenario_.start;
      check_standing_place("the start", truth_.start);
      return;
    }
    RandomStream random(scenario_.seed, "start");
    truth_.start = draw_standing_place("the start", random);
  }

  void place_carries() {
    truth_.events = scenario_.events;
    for (std::size_t i = 0; i < truth_.events.size(); ++i) {
      ScenarioEvent& event = truth_.events[i];
      if (event.kind == EventKind::kCarry && !event.has_place) {
        RandomStream random(scenario_.seed, "carry", i);
        event.pose = draw_standing_place("a carry", random);
        event.has_place = true;
      }
    }
  }

  Pose2 draw_standing_place(std::string_view what, RandomStream& random) {
    for (int i = 0; i < kTries; ++i) {
      const Vector2d point = space().draw_point(kStartClearance, random.generator());
      const double theta = random.uniform(-kPi, kPi);
      const auto is_near = [&](const Polygon& other) { return distance(other, point) < kFromObstacles; };
      if (std::none_of(given_.begin(), given_.end(), is_near)) {
        return {point.x(), point.y(), theta};
      }
    }
    fail(scenario_, fmt::format("no free place for {} between the obstacles", what));
  }

  void place_obstacles() {
    truth_.obstacles = scenario_.obstacles;
    if (given_.size() == truth_.holes.size() + scenario_.obstacles.size()) {
      return;
    }
    ObstaclePlacement placement(space());
    for (const Polygon& outline : given_) {
      placement.add(outline);
    }
    placement.keep_away_from(truth_.start.position());
    for (const ScenarioGoal& goal : scenario_.goals) {
      placement.keep_away_from(goal.pose.position());
    }
    for (const ScenarioEvent& event : truth_.events) {
      if (event.kind == EventKind::kCarry) {
        placement.keep_away_from(event.pose.position());
      }
    }
    for (const Door& door : truth_.building.doors) {
      placement.keep_away_from(door.world_from_door.position());
    }
    for (const WalkingPerson& person : scenario_.people) {
      for (std::size_t i = 1; i < person.waypoints.size(); ++i) {
        placement.keep_clear(person.waypoints[i - 1], person.waypoints[i]);
      }
    }
    for (std::size_t i = 0; i < truth_.obstacles.size(); ++i) {
      Obstacle& obstacle = truth_.obstacles[i];
      if (!obstacle.world_from_obstacle) {
        RandomStream random(scenario_.seed, "obstacle", i);
        obstacle.world_from_obstacle = placement.draw(obstacle, random);
      }
    }
  }

  void place_people() {
    truth_.people = scenario_.people;
    for (std::size_t i = 0; i < truth_.people.size(); ++i) {
      WalkingPerson& person = truth_.people[i];
      if (person.waypoints.empty()) {
        RandomStream random(scenario_.seed, "person", i);
        draw_path(random, person);
      }
      for (const Vector2d& waypoint : person.waypoints) {
        if (truth_.walls.at(waypoint) == Prior::kOccupied) {
          fail(scenario_, fmt::format("a person's waypoint [{}, {}] is in a wall", waypoint.x(), waypoint.y()));
        }
      }
    }
  }

  void draw_path(RandomStream& random, WalkingPerson& person) {
    for (int i = 0; i < kTries; ++i) {
      const Vector2d from = space().draw_point(kPersonClearance, random.generator());
      const Vector2d to = space().draw_point(kPersonClearance, random.generator());
      const auto is_in_the_way = [&](const Polygon& outline) {
        return distance(outline, Polygon{from, to}) < kPersonClearance;
      };
      const auto blocks = [&](const Obstacle& obstacle) {
        return is_in_the_way(rectangle(*obstacle.world_from_obstacle, obstacle.length, obstacle.width));
      };
      if ((to - from).norm() >= kPersonPath && (from - truth_.start.position()).norm() >= kPersonFromStart &&
          space().is_free_line(from, to, kPersonClearance) &&
          std::none_of(truth_.holes.begin(), truth_.holes.end(), is_in_the_way) &&
          std::none_of(truth_.obstacles.begin(), truth_.obstacles.end(), blocks)) {
        person.waypoints = {from, to};
        return;
      }
    }
    fail(scenario_, fmt::format("no free straight line of {} m for a person", kPersonPath));
  }

  void check_events() {
    for (const ScenarioEvent& event : truth_.events) {
      if (event.kind == EventKind::kCarry) {
        check_standing_place("the place of a carry", event.pose);
      } else if (event.kind == EventKind::kLamp) {
        (void)index_of_fixture(scenario_, truth_.building, event.id);
      } else if (event.kind == EventKind::kDoor) {
        const auto has_id = [&event](const Door& door) { return door.id == event.id; };
        if (std::none_of(truth_.building.doors.begin(), truth_.building.doors.end(), has_id)) {
          fail(scenario_, fmt::format("the building has no door {}", event.id));
        }
      }
      for (const std::vector<int>* ids : {&event.on, &event.off}) {
        for (const int id : *ids) {
          (void)index_of_fixture(scenario_, truth_.building, id);
        }
      }
    }
  }

  void check_standing_place(std::string_view what, const Pose2& pose) {
    const Polygon footprint = transform(pose, truth_.robot.footprint);
    const GridGeometry& map = truth_.walls.geometry;
    if (!truth_.walls.cells.empty() && !map.contains(map.cell_at(pose.position()))) {
      fail(scenario_, fmt::format("{} ({}, {}) is outside of the map", what, pose.x, pose.y));
    }
    if (overlaps_wall(truth_.walls, footprint)) {
      fail(scenario_, fmt::format("{} ({}, {}) is in a wall", what, pose.x, pose.y));
    }
    for (const Polygon& outline : given_) {
      if (distance(outline, footprint) <= 0.0) {
        fail(scenario_, fmt::format("{} ({}, {}) is in an obstacle or a hole", what, pose.x, pose.y));
      }
    }
  }

  const Scenario& scenario_;
  WorldTruth& truth_;
  std::optional<FreeSpace> space_;
  std::vector<Polygon> given_;  // outlines of the holes and of the obstacles whose place is given
};

}  // namespace

WorldTruth draw_world(const Scenario& scenario, const Building& believed, const RobotDescription& robot) {
  const WorldSpread spread = effective_spread(scenario.world);
  WorldTruth truth;
  truth.building = believed;
  truth.robot = robot;
  truth.feels_touch = scenario.base == "create2";
  truth.dock = scenario.dock;
  truth.battery_voltage = scenario.battery_voltage;
  if (!believed.map_file.empty()) {
    truth.walls = read_map(believed.map_file);
  }
  Table table;
  table.text = fmt::format("seed {}, calibrated {}\n", scenario.seed, spread.calibrated);
  draw_wheels(scenario, spread, truth, table);
  draw_camera(scenario, spread, truth, table);
  draw_ceiling(scenario, spread, truth, table);
  draw_lighting(scenario, truth, table);
  for (const Hole& hole : scenario.holes) {
    truth.holes.push_back(rectangle(hole.pose, hole.length, hole.width));
  }
  Placement(scenario, truth).run();
  truth.table = table.text;
  truth.hash = hash_of(truth.table);
  return truth;
}

}  // namespace luminav
