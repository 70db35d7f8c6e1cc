#include "services/surveyor/drive/sonar_map.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace luminav {
namespace {

constexpr double kResolution = 0.1;  // [m] as the mapper's own grid
constexpr int kMaxCells = 4096;      // per axis, as GRID_TILE's receivers accept
constexpr double kMaxTurn = 1.0;     // [rad/s] faster, errors of time become errors of angle
// [m] beyond the inscribed radius: what the planner keeps, and half the diagonal of a cell
constexpr double kPassageMargin = 0.0875 + 0.07;

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

/// An older map at the resolution of ours and on its own cells, wide enough for a grid.
PriorMap widened(const PriorMap& known, const GridGeometry& around) {
  const PriorMap old = resample(known, kResolution);
  const auto far = [](const GridGeometry& geometry) -> Eigen::Vector2d {
    return geometry.origin + geometry.resolution * Eigen::Vector2d(geometry.columns, geometry.rows);
  };
  const Eigen::Array2d before = ((old.geometry.origin - around.origin).array() / kResolution).ceil().max(0.0);
  const Eigen::Array2d behind = ((far(around) - far(old.geometry)).array() / kResolution).ceil().max(0.0);
  GridGeometry geometry = old.geometry;
  geometry.origin -= kResolution * before.matrix();
  geometry.columns += static_cast<int>(before.x() + behind.x());
  geometry.rows += static_cast<int>(before.y() + behind.y());
  if (std::max(geometry.columns, geometry.rows) > kMaxCells) {
    throw std::runtime_error("drive and building together span more than 409 m, which no map of the robot's holds");
  }
  PriorMap result = empty_map(geometry);
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      result.cells[geometry.index({column, row})] = old.at(geometry.centre_of({column, row}));
    }
  }
  return result;
}

/// Nothing stands where the robot drove, whatever an older map says.
void free_below(PriorMap& map, const Eigen::Vector2d& centre, double radius) {
  const int reach = static_cast<int>(std::ceil(radius / map.geometry.resolution));
  const Cell middle = map.geometry.cell_at(centre);
  for (int row = middle.row - reach; row <= middle.row + reach; ++row) {
    for (int column = middle.column - reach; column <= middle.column + reach; ++column) {
      const Cell cell{column, row};
      if (map.geometry.contains(cell) && (map.geometry.centre_of(cell) - centre).norm() <= radius) {
        map.cells[map.geometry.index(cell)] = Prior::kFree;
      }
    }
  }
}

/// Frees what the sonars draw into a passage: where the robot drove between two things, it fits again. Their cones make
/// the posts of a door too wide, and a planner keeps more distance than the robot needed.
void open_passages(PriorMap& map, const std::vector<SurveyedPath::Stop>& stops, double radius) {
  const int reach = static_cast<int>(std::ceil(radius / map.geometry.resolution));
  for (const SurveyedPath::Stop& stop : stops) {
    std::vector<std::size_t> left;
    std::vector<std::size_t> right;
    const Cell centre = map.geometry.cell_at(stop.world_from_robot.position());
    for (int row = centre.row - reach; row <= centre.row + reach; ++row) {
      for (int column = centre.column - reach; column <= centre.column + reach; ++column) {
        const Cell cell{column, row};
        const Eigen::Vector2d beside = stop.world_from_robot.inverse() * map.geometry.centre_of(cell);
        if (map.geometry.contains(cell) && beside.norm() <= radius &&
            map.cells[map.geometry.index(cell)] == Prior::kOccupied) {
          (beside.y() > 0.0 ? left : right).push_back(map.geometry.index(cell));
        }
      }
    }
    if (!left.empty() && !right.empty()) {
      for (const std::vector<std::size_t>& side : {left, right}) {
        std::for_each(side.begin(), side.end(), [&map](std::size_t i) { map.cells[i] = Prior::kFree; });
      }
    }
  }
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

PriorMap empty_map(const GridGeometry& geometry) {
  PriorMap map;
  map.geometry = geometry;
  map.cells.assign(geometry.size(), Prior::kUnknown);
  return map;
}

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

SonarMap::SonarMap(const RobotDescription& robot, const GridGeometry& geometry)
    : SonarMap(robot, empty_map(geometry)) {}

SonarMap::SonarMap(const RobotDescription& robot, const PriorMap& known)
    : robot_(robot), mapper_(mapping_params(robot), known, static_cast<int>(robot.sonar.robot_from_sonar.size())) {}

void SonarMap::hear(const SonarEcho& echo) {
  if (static_cast<std::size_t>(echo.disc) < robot_.sonar.robot_from_sonar.size() &&
      (!last_ || echo.utime >= last_->utime)) {
    waiting_.push_back(echo);
  }
}

void SonarMap::go_on(const SurveyedPath::Stop& stop) {
  if (last_ && next_) {
    draw_until(*next_);
    mapper_.mark_robot(next_->world_from_robot);
  }
  last_ = next_;
  next_ = stop;
}

void SonarMap::draw_until(const SurveyedPath::Stop& next) {
  std::stable_sort(waiting_.begin(), waiting_.end(),
                   [](const SonarEcho& a, const SonarEcho& b) { return a.utime < b.utime; });
  const auto begin = std::find_if(waiting_.begin(), waiting_.end(),
                                  [this](const SonarEcho& echo) { return echo.utime >= last_->utime; });
  const auto end = std::find_if(begin, waiting_.end(), [&](const SonarEcho& echo) { return echo.utime >= next.utime; });
  if (last_->part == next.part && std::abs(last_->angular) <= kMaxTurn) {
    std::for_each(begin, end, [&](const SonarEcho& echo) { draw(echo, next); });
  }
  waiting_.erase(waiting_.begin(), end);
}

void SonarMap::draw(const SonarEcho& echo, const SurveyedPath::Stop& next) {
  const double share = static_cast<double>(echo.utime - last_->utime) / static_cast<double>(next.utime - last_->utime);
  const Pose2 pose = interpolate(last_->world_from_robot, next.world_from_robot, share);
  mapper_.integrate({echo.disc, echo.utime, pose,
                     pose * robot_.sonar.robot_from_sonar[static_cast<std::size_t>(echo.disc)], echo.range,
                     echo.has_echo});
}

GridGeometry geometry_around(const std::vector<SurveyedPath::Stop>& stops, double margin) {
  Eigen::Vector2d low = stops.front().world_from_robot.position();
  Eigen::Vector2d high = low;
  for (const SurveyedPath::Stop& stop : stops) {
    low = low.cwiseMin(stop.world_from_robot.position());
    high = high.cwiseMax(stop.world_from_robot.position());
  }
  GridGeometry geometry;
  geometry.resolution = kResolution;
  geometry.origin = ((low.array() - margin) / kResolution).floor() * kResolution;
  const Eigen::Vector2d size = (high - geometry.origin).array() + margin;
  if (size.maxCoeff() > kMaxCells * kResolution) {
    throw std::runtime_error("the drive spans more than 409 m, which no map of the robot's holds");
  }
  geometry.columns = static_cast<int>(std::ceil(size.x() / kResolution));
  geometry.rows = static_cast<int>(std::ceil(size.y() / kResolution));
  return geometry;
}

SonarMap draw_along(const std::vector<SonarEcho>& echoes, const std::vector<SurveyedPath::Stop>& stops,
                    const RobotDescription& robot, const PriorMap& known) {
  SonarMap map(robot, known);
  std::vector<SonarEcho> sorted = echoes;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const SonarEcho& a, const SonarEcho& b) { return a.utime < b.utime; });
  auto echo = sorted.begin();
  for (const SurveyedPath::Stop& stop : stops) {
    for (; echo != sorted.end() && echo->utime < stop.utime; ++echo) {
      map.hear(*echo);
    }
    map.go_on(stop);
  }
  map.go_on(stops.back());
  return map;
}

PriorMap draw_sonar_map(const std::vector<SonarEcho>& echoes, const SurveyedPath& path, const RobotDescription& robot,
                        const std::vector<Eigen::Vector2d>& above, const PriorMap* known) {
  const std::vector<SurveyedPath::Stop>& stops = path.stops();
  if (stops.size() < 2) {
    throw std::runtime_error("the drive is too short to draw a map from");
  }
  const GridGeometry around = geometry_around(stops, robot.sonar.maximum_range + 1.0);
  SonarMap map = draw_along(echoes, stops, robot, known != nullptr ? widened(*known, around) : empty_map(around));
  for (const SurveyedPath::Stop& stop : stops) {
    map.mapper().mark_robot(stop.world_from_robot);
  }
  PriorMap combined = map.mapper().combined();
  for (auto stop = stops.begin(); stop != stops.end() && known != nullptr; ++stop) {
    free_below(combined, stop->world_from_robot.position(), robot.inscribed_radius());
  }
  open_passages(combined, stops, robot.inscribed_radius() + kPassageMargin);
  return cropped(combined, above);
}

}  // namespace luminav
