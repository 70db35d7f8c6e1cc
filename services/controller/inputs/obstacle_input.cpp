#include "services/controller/inputs/obstacle_input.hpp"

#include <algorithm>
#include <cmath>

#include "services/controller/following/local_map.hpp"
#include "services/controller/safety/facing_wall.hpp"

namespace luminav {
namespace {

constexpr double kFarthest = 50.0;  // [m] what no sonar measures

}  // namespace

void ObstacleInput::take(const sonar_t& message, const RecentOdometry& odometry, const std::optional<PlacedGrid>& map,
                         const std::function<void(const char*)>& drop) {
  const SonarRing& ring = echoes_.ring();
  const auto count = static_cast<std::size_t>(std::max(0, message.count));
  if (count != ring.robot_from_sonar.size() || message.range.size() != count || message.has_echo.size() != count ||
      message.range_utime.size() != count) {
    drop("SONAR: not the number of discs of the robot's file");
    return;
  }
  if (odometry.empty() || odometry.newest().session != message.session) {
    return;  // the place of these readings is unknown
  }
  WallTest is_wall;
  if (map) {
    is_wall = [&map](const Eigen::Vector2d& point, double distance) {
      return has_wall_near(map->grid, map->world_from_odom * point, distance);
    };
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double range = message.range[i];
    const std::int64_t utime = message.range_utime[i];
    if (utime <= echoes_.newest()[i].utime) {
      continue;  // told already
    }
    const std::optional<Pose2> place = odometry.odom_from_robot_at(utime);
    if (!place && utime < odometry.began()) {
      continue;  // each SONAR tells of all discs: some fired before this process listened
    }
    if (!std::isfinite(range) || range < 0.0 || range > kFarthest || !place || odometry.is_too_far_ahead(utime)) {
      drop("SONAR: impossible range or stamp");
      continue;
    }
    const bool has_echo = message.has_echo[i] != 0 && range < ring.maximum_range - 0.01;
    const SonarFiring firing{i, utime, range, has_echo, *place};
    echoes_.add(firing, is_wall);
    sonar_watch_.add(firing, map ? expect(i, map->world_from_odom * *place, map->grid) : SonarWatch::Place{});
  }
}

SonarWatch::Place ObstacleInput::expect(std::size_t disc, const Pose2& world_from_robot,
                                        const OccupancyGrid& grid) const {
  const SonarRing& ring = echoes_.ring();
  const Pose2 world_from_sonar = world_from_robot * ring.robot_from_sonar[disc];
  const Cell cell = grid.geometry.cell_at(world_from_sonar.position());
  if (!grid.geometry.contains(cell) || grid.prior[grid.geometry.index(cell)] == Prior::kUnknown) {
    return {};
  }
  return {true, facing_wall(grid, world_from_sonar, ring.half_angle, SonarWatch::kWall)};
}

void ObstacleInput::clear() {
  echoes_.clear();
  sonar_watch_.forget_motion();
  touches_.clear();
}

void ObstacleInput::describe(std::int64_t utime, const Pose2& odom_from_robot, ControlInput& input) const {
  if (input.task == ControlTask::kWander) {
    input.echoes = echoes_.obstacles_without_map(utime, odom_from_robot);
    input.remembered = echoes_.remembered(utime, odom_from_robot);
    input.firings = echoes_.newest();
    touches_.append(utime, odom_from_robot, input.remembered);
  } else {
    input.echoes = echoes_.obstacles(utime, odom_from_robot);
  }
  touches_.append(utime, odom_from_robot, input.echoes);
}

void ObstacleInput::judge(std::int64_t utime, SenseAges& ages) const {
  judge_disc_ages(echoes_, utime, ages);
  ages.doubt = sonar_watch_.reason();
}

}  // namespace luminav
