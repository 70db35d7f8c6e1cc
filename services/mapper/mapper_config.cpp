#include "services/mapper/mapper_config.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

constexpr double kMarginWithoutMap = 10.0;  // [m] walls may stand this far beyond the outermost fixture
constexpr int kMaxCells = 4096;             // per axis, as GRID_TILE's receivers accept

void read_sonar_model(const TomlTable& table, const RobotDescription& robot, SonarModelParams& sonar) {
  const SonarRing& ring = robot.sonar;
  const bool is_paper = table.choice("mode", robot.mode, {"paper", "modern"}) == "paper";
  sonar.kind = is_paper ? SonarModelKind::kLine : SonarModelKind::kCone;
  sonar.half_angle = ring.half_angle;
  sonar.minimum_range = ring.minimum_range;
  sonar.maximum_range = ring.maximum_range;
  sonar.free_log_odds = table.number("free_log_odds", sonar.free_log_odds, {0.0, 3.0});
  sonar.core_log_odds = table.number("core_log_odds", sonar.core_log_odds, {0.0, 3.0});
  sonar.core_range = table.number("core_range", sonar.core_range, {0.0, 20.0});
  sonar.occupied_log_odds = table.number("occupied_log_odds", sonar.occupied_log_odds, {0.05, 5.0});
  sonar.edge_weight = table.number("edge_weight", sonar.edge_weight, kFraction);
  sonar.occupied_range = table.number("occupied_range", sonar.occupied_range, {0.1, 20.0});
  sonar.free_range = table.number("free_range", sonar.free_range, {0.1, 20.0});
  sonar.no_echo_share = table.number("no_echo_share", sonar.no_echo_share, kFraction);
  sonar.no_echo_range = table.number("no_echo_range", sonar.no_echo_range, {0.0, 20.0});
  sonar.free_margin = table.number("free_margin", sonar.free_margin, {0.0, 1.0});
  sonar.min_log_odds = table.number("min_log_odds", sonar.min_log_odds, {-6.0, -0.1});
  sonar.max_log_odds = table.number("max_log_odds", sonar.max_log_odds, {0.1, 6.0});
}

void read_grid_mapper(const TomlTable& table, GridMapperParams& grid) {
  grid.filter.memory = table.number("echo_memory", grid.filter.memory, {0.05, 10.0});
  grid.filter.distance = table.number("echo_distance", grid.filter.distance, {0.01, 2.0});
  grid.occupied_log_odds = table.number("occupied_threshold", grid.occupied_log_odds, {0.05, grid.passing_log_odds});
  grid.prior_tolerance = table.number("prior_tolerance", grid.prior_tolerance, {0.0, 1.0});
  grid.explained_share = table.number("explained_share", grid.explained_share, kFraction);
  grid.mirror_range = table.number("mirror_range", grid.mirror_range, {0.0, 20.0});
  grid.mirror_share = table.number("mirror_share", grid.mirror_share, kFraction);
  grid.surface_cells = table.number("surface_cells", grid.surface_cells, {0.0, 100.0});
  grid.arc_sharpness = table.number("arc_sharpness", grid.arc_sharpness, {0.0, 10.0});
  grid.known_log_odds = table.number("known_log_odds", grid.known_log_odds, {-1.0, 10.0});
  grid.narrow_range = table.number("narrow_range", grid.narrow_range, {0.0, 20.0});
  grid.wall_thickness = table.number("wall_thickness", grid.wall_thickness, {0.0, 1.0});
  grid.view_distance = table.number("view_distance", grid.view_distance, {0.0, 10.0});
  grid.standing_time = table.number("standing_time", grid.standing_time, {0.0, 60.0});
  grid.decay_time = table.number("decay_time", grid.decay_time, {0.0, 1e6});
  grid.dispute_range = table.number("dispute_range", grid.dispute_range, {0.0, 20.0});
}

}  // namespace

PriorMap unknown_map(const std::filesystem::path& building_file, double resolution, double margin) {
  const Building building = read_building(building_file);
  Eigen::Vector2d low(0.0, 0.0);
  Eigen::Vector2d high(0.0, 0.0);
  const auto include = [&](const Pose2& pose) {
    low = low.cwiseMin(pose.position());
    high = high.cwiseMax(pose.position());
  };
  for (const Fixture& fixture : building.fixtures) {
    include(fixture.world_from_fixture);
  }
  for (const Door& door : building.doors) {
    include(door.world_from_door);
  }
  for (const Place& place : building.places) {
    include(place.pose);
  }
  PriorMap map;
  map.geometry.resolution = resolution;
  map.geometry.origin = ((low.array() - margin) / resolution).floor() * resolution;
  const Eigen::Vector2d size = (high - map.geometry.origin).array() + margin;
  map.geometry.columns = static_cast<int>(std::ceil(size.x() / resolution));
  map.geometry.rows = static_cast<int>(std::ceil(size.y() / resolution));
  if (map.geometry.columns <= kMaxCells && map.geometry.rows <= kMaxCells) {
    map.cells.assign(map.geometry.size(), Prior::kUnknown);
  }
  return map;
}

MapperConfig read_mapper_config(const std::filesystem::path& robot_file, const std::filesystem::path& building_file) {
  const TomlTable root = TomlTable::load(robot_file);
  MapperConfig config;
  config.robot = read_robot(root);
  const TomlTable table = root.table("mapper");
  read_sonar_model(table, config.robot, config.grid.sonar);
  read_grid_mapper(table, config.grid);
  config.grid.robot_radius = config.robot.inscribed_radius();
  config.tiles.changed_period = table.number("changed_period", config.tiles.changed_period, {0.0, 10.0});
  config.tiles.round_period = table.number("round_period", config.tiles.round_period, {0.5, 10.0});
  config.resolution = table.number("resolution", config.resolution, {0.02, 1.0});
  config.position_limit = table.number("position_limit", config.position_limit, kPositive);
  config.heading_limit = table.number("heading_limit", config.heading_limit, kPositive);
  config.turn_limit = table.number("turn_limit", config.turn_limit, kPositive);
  config.keep_period = table.number("keep_period", config.keep_period, {1.0, 1e6});
  const bool use_map = table.boolean("use_building_map", true);
  table.reject_unknown();

  const Building building = read_building(building_file);
  config.prior = use_map && !building.map_file.empty()
                     ? resample(read_map(building.map_file), config.resolution)
                     : unknown_map(building_file, config.resolution, kMarginWithoutMap);
  const GridGeometry& geometry = config.prior.geometry;
  if (geometry.columns > kMaxCells || geometry.rows > kMaxCells) {
    table.fail("resolution", "makes a grid of " + std::to_string(geometry.columns) + " x " +
                                 std::to_string(geometry.rows) + " cells, must be at most 4096 x 4096");
  }
  return config;
}

}  // namespace luminav
