#include "services/mapper/mapper_config.hpp"

#include <cmath>

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
  table.read("free_log_odds", sonar.free_log_odds, {0.0, 3.0});
  table.read("core_log_odds", sonar.core_log_odds, {0.0, 3.0});
  table.read("core_range", sonar.core_range, {0.0, 20.0});
  table.read("occupied_log_odds", sonar.occupied_log_odds, {0.05, 5.0});
  table.read("edge_weight", sonar.edge_weight, kFraction);
  table.read("occupied_range", sonar.occupied_range, {0.1, 20.0});
  table.read("free_range", sonar.free_range, {0.1, 20.0});
  table.read("no_echo_share", sonar.no_echo_share, kFraction);
  table.read("no_echo_range", sonar.no_echo_range, {0.0, 20.0});
  table.read("free_margin", sonar.free_margin, {0.0, 1.0});
  table.read("min_log_odds", sonar.min_log_odds, {-6.0, -0.1});
  table.read("max_log_odds", sonar.max_log_odds, {0.1, 6.0});
}

void read_grid_mapper(const TomlTable& table, GridMapperParams& grid) {
  table.read("echo_memory", grid.filter.memory, {0.05, 10.0});
  table.read("echo_distance", grid.filter.distance, {0.01, 2.0});
  table.read("occupied_threshold", grid.occupied_log_odds, {0.05, GridMapper::kPassingLogOdds});
  table.read("prior_tolerance", grid.prior_tolerance, {0.0, 1.0});
  table.read("explained_share", grid.explained_share, kFraction);
  table.read("mirror_range", grid.mirror_range, {0.0, 20.0});
  table.read("mirror_share", grid.mirror_share, kFraction);
  table.read("surface_cells", grid.surface_cells, {0.0, 100.0});
  table.read("arc_sharpness", grid.arc_sharpness, {0.0, 10.0});
  table.read("known_log_odds", grid.known_log_odds, {-1.0, 10.0});
  table.read("narrow_range", grid.narrow_range, {0.0, 20.0});
  table.read("wall_thickness", grid.wall_thickness, {0.0, 1.0});
  table.read("view_distance", grid.view_distance, {0.0, 10.0});
  table.read("standing_time", grid.standing_time, {0.0, 60.0});
  table.read("decay_time", grid.decay_time, {0.0, 1e6});
  table.read("dispute_range", grid.dispute_range, {0.0, 20.0});
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
  table.read("changed_period", config.tiles.changed_period, {0.0, 10.0});
  table.read("round_period", config.tiles.round_period, {0.5, 10.0});
  table.read("resolution", config.resolution, {0.02, 1.0});
  table.read("position_limit", config.position_limit, kPositive);
  table.read("heading_limit", config.heading_limit, kPositive);
  table.read("turn_limit", config.turn_limit, kPositive);
  table.read("keep_period", config.keep_period, {1.0, 1e6});
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
