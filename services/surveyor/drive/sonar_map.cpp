#include "services/surveyor/drive/sonar_map.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "services/mapper/grid_mapper.hpp"

namespace luminav {
namespace {

constexpr double kResolution = 0.1;  // [m] as the mapper's own grid
constexpr int kMaxCells = 4096;      // per axis, as GRID_TILE's receivers accept
constexpr double kMaxTurn = 1.0;     // [rad/s] faster, errors of time become errors of angle

/// What launch/robots/p3dx-mapping.toml sets for a map that is drawn for the first time.
GridMapperParams mapping_params(const RobotDescription& robot) {
  GridMapperParams params;
  params.sonar.half_angle = robot.sonar.half_angle;
  params.sonar.minimum_range = robot.sonar.minimum_range;
  params.sonar.maximum_range = robot.sonar.maximum_range;
  params.sonar.occupied_range = 5.0;
  params.sonar.no_echo_share = 0.2;
  params.sonar.max_log_odds = 3.3;
  params.mirror_share = 0.5;
  params.narrow_range = 1.2;
  params.robot_radius = robot.inscribed_radius();
  return params;
}

PriorMap empty_map(const std::vector<SurveyedPath::Stop>& stops, double margin) {
  Eigen::Vector2d low = stops.front().world_from_robot.position();
  Eigen::Vector2d high = low;
  for (const SurveyedPath::Stop& stop : stops) {
    low = low.cwiseMin(stop.world_from_robot.position());
    high = high.cwiseMax(stop.world_from_robot.position());
  }
  PriorMap map;
  map.geometry.resolution = kResolution;
  map.geometry.origin = ((low.array() - margin) / kResolution).floor() * kResolution;
  const Eigen::Vector2d size = (high - map.geometry.origin).array() + margin;
  if (size.maxCoeff() > kMaxCells * kResolution) {
    throw std::runtime_error("the drive spans more than 409 m, which no map of the robot's holds");
  }
  map.geometry.columns = static_cast<int>(std::ceil(size.x() / kResolution));
  map.geometry.rows = static_cast<int>(std::ceil(size.y() / kResolution));
  map.cells.assign(map.geometry.size(), Prior::kUnknown);
  return map;
}

/// The map without the rows and columns at its borders of which nothing is known and above which nothing hangs, but for
/// one all round.
PriorMap cropped(const PriorMap& map, const std::vector<Eigen::Vector2d>& above) {
  Cell low{map.geometry.columns, map.geometry.rows};
  Cell high{-1, -1};
  for (const Eigen::Vector2d& point : above) {
    const Cell cell = map.geometry.cell_at(point);
    low = {std::max(0, std::min(low.column, cell.column)), std::max(0, std::min(low.row, cell.row))};
    high = {std::max(high.column, cell.column), std::max(high.row, cell.row)};
  }
  for (int row = 0; row < map.geometry.rows; ++row) {
    for (int column = 0; column < map.geometry.columns; ++column) {
      if (map.cells[map.geometry.index({column, row})] != Prior::kUnknown) {
        low = {std::min(low.column, column), std::min(low.row, row)};
        high = {std::max(high.column, column), std::max(high.row, row)};
      }
    }
  }
  if (high.column < 0) {
    return map;
  }
  PriorMap result;
  result.geometry = map.geometry;
  const Cell first{std::max(0, low.column - 1), std::max(0, low.row - 1)};
  result.geometry.columns = std::min(map.geometry.columns, high.column + 2) - first.column;
  result.geometry.rows = std::min(map.geometry.rows, high.row + 2) - first.row;
  result.geometry.origin += kResolution * Eigen::Vector2d(first.column, first.row);
  for (int row = 0; row < result.geometry.rows; ++row) {
    for (int column = 0; column < result.geometry.columns; ++column) {
      result.cells.push_back(map.cells[map.geometry.index({first.column + column, first.row + row})]);
    }
  }
  return result;
}

}  // namespace

SurveyedPath::SurveyedPath(const std::vector<OdometryReading>& odometry, const std::vector<KeyFrame>& frames,
                           const std::vector<Pose2>& poses) {
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    const KeyFrame& from = frames[i];
    const KeyFrame& to = frames[i + 1];
    if (from.part != to.part) {
      continue;
    }
    const auto span = static_cast<double>(to.utime - from.utime);
    const Pose2 told = from.odom_from_robot.inverse() * to.odom_from_robot;
    const Pose2 went = poses[i].inverse() * poses[i + 1];
    const Pose2 missed = told.inverse() * went;
    auto reading = std::lower_bound(odometry.begin(), odometry.end(), from.utime,
                                    [](const OdometryReading& each, std::int64_t utime) { return each.utime < utime; });
    for (; reading != odometry.end() && reading->utime < to.utime; ++reading) {
      const double share = static_cast<double>(reading->utime - from.utime) / span;
      const Pose2 step = from.odom_from_robot.inverse() * reading->odom_from_robot;
      stops_.push_back(
          {reading->utime, from.part, poses[i] * step * interpolate(Pose2{}, missed, share), reading->angular});
    }
  }
  std::stable_sort(stops_.begin(), stops_.end(), [](const Stop& a, const Stop& b) { return a.utime < b.utime; });
}

PriorMap draw_sonar_map(const std::vector<SonarEcho>& echoes, const SurveyedPath& path, const RobotDescription& robot,
                        const std::vector<Eigen::Vector2d>& above) {
  const std::vector<SurveyedPath::Stop>& stops = path.stops();
  if (stops.size() < 2) {
    throw std::runtime_error("the drive is too short to draw a map from");
  }
  const PriorMap empty = empty_map(stops, robot.sonar.maximum_range + 1.0);
  GridMapper mapper(mapping_params(robot), empty, static_cast<int>(robot.sonar.robot_from_sonar.size()));
  std::vector<SonarEcho> sorted = echoes;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const SonarEcho& a, const SonarEcho& b) { return a.utime < b.utime; });
  std::size_t at = 0;
  for (const SonarEcho& echo : sorted) {
    while (at + 1 < stops.size() && stops[at + 1].utime <= echo.utime) {
      ++at;
      mapper.mark_robot(stops[at].world_from_robot);
    }
    const bool is_on_path =
        echo.utime >= stops.front().utime && at + 1 < stops.size() && stops[at].part == stops[at + 1].part;
    if (!is_on_path || std::abs(stops[at].angular) > kMaxTurn ||
        static_cast<std::size_t>(echo.disc) >= robot.sonar.robot_from_sonar.size()) {
      continue;
    }
    const double share =
        static_cast<double>(echo.utime - stops[at].utime) / static_cast<double>(stops[at + 1].utime - stops[at].utime);
    const Pose2 pose = interpolate(stops[at].world_from_robot, stops[at + 1].world_from_robot, share);
    mapper.integrate({echo.disc, echo.utime, pose,
                      pose * robot.sonar.robot_from_sonar[static_cast<std::size_t>(echo.disc)], echo.range,
                      echo.has_echo});
  }
  for (const SurveyedPath::Stop& stop : stops) {
    mapper.mark_robot(stop.world_from_robot);
  }
  return cropped(mapper.combined(), above);
}

}  // namespace luminav
