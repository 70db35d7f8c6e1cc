#include "tests/unit/mapper/mapping_drive.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "drivers/simulator/geometry/random_stream.hpp"
#include "drivers/simulator/world/scene.hpp"
#include "drivers/simulator/world/sonar_beam.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/planner/path/route_planner.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kTick = 0.04;  // [s] one pulse of each array
constexpr double kSpeed = 0.4;  // [m/s]
constexpr double kTurn = 0.6;   // [rad/s]

/// Poses at each tick along the planned ways, turning at the corners as a robot must.
std::vector<Pose2> walk(const MappingDrive& drive, const PriorMap& truth) {
  OccupancyGrid grid(truth.geometry);
  grid.prior = truth.cells;
  for (const Obstacle& obstacle : drive.obstacles) {
    const Pose2& pose = *obstacle.world_from_obstacle;
    for (int row = 0; row < grid.geometry.rows; ++row) {
      for (int column = 0; column < grid.geometry.columns; ++column) {
        const Vector2d p = pose.inverse() * grid.geometry.centre_of({column, row});
        if (std::abs(p.x()) <= 0.5 * obstacle.length && std::abs(p.y()) <= 0.5 * obstacle.width) {
          grid.prior[grid.geometry.index({column, row})] = Prior::kOccupied;
        }
      }
    }
  }
  RoutePlanner planner{RoutePlannerParams{}};
  planner.set_grid(grid, {});
  std::vector<Pose2> poses = {{drive.waypoints[0].x(), drive.waypoints[0].y(), 0.0}};
  for (std::size_t i = 1; i < drive.waypoints.size(); ++i) {
    const Route route = planner.plan({drive.waypoints[i - 1], drive.waypoints[i], 0.0});
    if (route.outcome != RouteOutcome::kFound) {
      throw std::runtime_error("the mapping drive cannot reach a waypoint");
    }
    for (std::size_t k = 1; k < route.points.size();) {
      Pose2 pose = poses.back();
      const Vector2d offset = route.points[k] - pose.position();
      const double error = offset.norm() < 1e-6 ? 0.0 : wrap_angle(std::atan2(offset.y(), offset.x()) - pose.theta);
      pose.theta = wrap_angle(pose.theta + std::clamp(error, -kTurn * kTick, kTurn * kTick));
      if (std::abs(error) < radians(30.0)) {
        const double step = std::min(kSpeed * kTick, offset.norm());
        pose.x += step * offset.x() / std::max(1e-9, offset.norm());
        pose.y += step * offset.y() / std::max(1e-9, offset.norm());
      }
      poses.push_back(pose);
      k += (route.points[k] - pose.position()).norm() < 1e-3 ? 1 : 0;
    }
  }
  return poses;
}

struct Face {
  Vector2d point;
  Vector2d normal;
  bool seen = false;
};

/// Middles of the sides between occupied and free cells of the true map.
std::vector<Face> faces_of(const PriorMap& truth) {
  std::vector<Face> faces;
  const GridGeometry& geometry = truth.geometry;
  for (int row = 1; row + 1 < geometry.rows; ++row) {
    for (int column = 1; column + 1 < geometry.columns; ++column) {
      if (truth.cells[geometry.index({column, row})] != Prior::kOccupied) {
        continue;
      }
      for (const auto& [dc, dr] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (truth.cells[geometry.index({column + dc, row + dr})] == Prior::kFree) {
          const Vector2d normal(dc, dr);
          faces.push_back({geometry.centre_of({column, row}) + 0.5 * geometry.resolution * normal, normal});
        }
      }
    }
  }
  return faces;
}

void mark_seen(const Scene& scene, const Pose2& world_from_sonar, std::vector<Face>& faces) {
  for (Face& face : faces) {
    const Vector2d offset = face.point - world_from_sonar.position();
    if (face.seen || offset.squaredNorm() > 9.0 || -offset.dot(face.normal) < std::cos(radians(60.0)) * offset.norm()) {
      continue;  // farther than 3 m, or looked at more obliquely than 60 degrees
    }
    const double off_axis = wrap_angle(std::atan2(offset.y(), offset.x()) - world_from_sonar.theta);
    const bool in_cone = std::abs(off_axis) < radians(15.0);
    face.seen = in_cone && !scene.cast_ray(world_from_sonar.position(), offset.normalized(), offset.norm() - 0.06, {});
  }
}

/// Slowly varying error of the pose: a random walk that is pulled back.
class PoseError {
 public:
  PoseError(const MappingDrive& drive) : drive_(drive), random_(drive.seed, "pose error") {}
  Pose2 next() {
    constexpr double kKeep = 0.98;  // over 2 s
    const double fresh = std::sqrt(1.0 - kKeep * kKeep);
    error_.x = kKeep * error_.x + random_.gaussian(fresh * drive_.position_noise);
    error_.y = kKeep * error_.y + random_.gaussian(fresh * drive_.position_noise);
    error_.theta = kKeep * error_.theta + random_.gaussian(fresh * drive_.heading_noise);
    return error_;
  }

 private:
  const MappingDrive& drive_;
  RandomStream random_;
  Pose2 error_;
};

bool is_in_obstacle(const std::vector<Obstacle>& obstacles, const Vector2d& p) {
  return std::any_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& obstacle) {
    const Vector2d q = obstacle.world_from_obstacle->inverse() * p;
    return std::abs(q.x()) < 0.5 * obstacle.length + 0.15 && std::abs(q.y()) < 0.5 * obstacle.width + 0.15;
  });
}

/// What sonar alone says where the building's map says free.
void count_evidence(const GridMapper& mapper, const PriorMap& walls, const std::vector<Obstacle>& obstacles,
                    MapQuality& quality) {
  const GridGeometry& geometry = mapper.grid().geometry;
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      const Cell cell{column, row};
      const Vector2d centre = geometry.centre_of(cell);
      if (!mapper.is_occupied(cell) || mapper.grid().prior[geometry.index(cell)] == Prior::kOccupied) {
        continue;
      }
      bool near_wall = false;
      for (double dy = -0.15; dy <= 0.16; dy += 0.05) {
        for (double dx = -0.15; dx <= 0.16; dx += 0.05) {
          near_wall = near_wall || walls.at(centre + Vector2d(dx, dy)) == Prior::kOccupied;
        }
      }
      const bool in_obstacle = is_in_obstacle(obstacles, centre);
      quality.obstacle_cells += in_obstacle ? 1 : 0;
      quality.phantom_cells += !in_obstacle && !near_wall ? 1 : 0;
    }
  }
}

MapQuality score(const PriorMap& map, const PriorMap& truth, const std::vector<Face>& faces,
                 const std::vector<Obstacle>& obstacles) {
  MapQuality quality;
  quality.map = map;
  std::vector<double> distances;
  int right = 0;
  for (int row = 0; row < map.geometry.rows; ++row) {
    for (int column = 0; column < map.geometry.columns; ++column) {
      const Vector2d centre = map.geometry.centre_of({column, row});
      const Prior cell = map.cells[map.geometry.index({column, row})];
      if (cell == Prior::kFree) {
        ++quality.free_cells;
        right += truth.at(centre) == Prior::kFree && !is_in_obstacle(obstacles, centre) ? 1 : 0;
      } else if (cell == Prior::kOccupied && !is_in_obstacle(obstacles, centre)) {
        double nearest = 5.0;
        for (const Face& face : faces) {
          // to the side of the true map's cell, not only to its middle
          const Vector2d offset = centre - face.point;
          const double across = offset.dot(face.normal);
          const double along = std::abs(offset.x() * face.normal.y() - offset.y() * face.normal.x());
          nearest = std::min(nearest, std::hypot(across, std::max(0.0, along - 0.025)));
        }
        distances.push_back(nearest);
      }
    }
  }
  quality.occupied_cells = static_cast<int>(distances.size());
  quality.free_precision = quality.free_cells == 0 ? 0.0 : static_cast<double>(right) / quality.free_cells;
  if (!distances.empty()) {
    std::sort(distances.begin(), distances.end());
    quality.wall_median = distances[distances.size() / 2];
    quality.wall_p95 = distances[distances.size() * 95 / 100];
  }
  int seen = 0;
  int found = 0;
  for (const Face& face : faces) {
    if (!face.seen) {
      continue;
    }
    ++seen;
    const Cell cell = map.geometry.cell_at(face.point - 0.01 * face.normal);
    bool hit = false;
    for (int dr = -1; dr <= 1; ++dr) {
      for (int dc = -1; dc <= 1; ++dc) {
        const Cell near{cell.column + dc, cell.row + dr};
        hit = hit || (map.geometry.contains(near) && map.cells[map.geometry.index(near)] == Prior::kOccupied);
      }
    }
    found += hit ? 1 : 0;
  }
  quality.recall = seen == 0 ? 0.0 : static_cast<double>(found) / seen;
  return quality;
}

}  // namespace

MapQuality drive_and_map(const MappingDrive& drive) {
  const Building building = read_building(drive.building_file);
  WorldTruth world;
  world.building = building;
  world.walls = read_map(building.map_file);
  world.robot = read_robot(drive.robot_file);
  world.obstacles = drive.obstacles;
  const Scene scene(world);
  const SonarRing& ring = world.robot.sonar;
  SonarBeam sonar(ring, drive.seed);

  const PriorMap truth = resample(world.walls, 0.1);
  PriorMap prior = truth;
  if (!drive.use_prior) {
    std::fill(prior.cells.begin(), prior.cells.end(), Prior::kUnknown);
  }
  GridMapperParams params = drive.params;
  params.sonar.half_angle = ring.half_angle;
  params.sonar.minimum_range = ring.minimum_range;
  params.sonar.maximum_range = ring.maximum_range;
  const int discs = static_cast<int>(ring.robot_from_sonar.size());
  GridMapper mapper(params, prior, discs);

  std::vector<Face> faces = faces_of(world.walls);
  PoseError error(drive);
  std::int64_t utime = 1'000'000;
  int pulse = 0;
  Pose2 before;
  for (const Pose2& truth_pose : walk(drive, truth)) {
    utime += static_cast<std::int64_t>(kTick * 1e6);
    const Pose2 noise = error.next();
    const Pose2 believed{truth_pose.x + noise.x, truth_pose.y + noise.y, wrap_angle(truth_pose.theta + noise.theta)};
    const bool turns = std::abs(wrap_angle(truth_pose.theta - before.theta)) > 0.55 * kTick;
    before = truth_pose;
    ++pulse;
    for (const int disc : {pulse % (discs / 2), discs / 2 + pulse % (discs / 2)}) {
      const Pose2& robot_from_sonar = ring.robot_from_sonar[static_cast<std::size_t>(disc)];
      const double range = sonar.measure(scene, truth_pose, disc);
      if (!turns) {
        mark_seen(scene, truth_pose * robot_from_sonar, faces);
        mapper.integrate({disc, utime, believed, believed * robot_from_sonar, range, range < ring.maximum_range});
      }
    }
    mapper.mark_robot(believed);
    mapper.decay(utime);
  }
  MapQuality quality = score(mapper.combined(), world.walls, faces, drive.obstacles);
  count_evidence(mapper, world.walls, drive.obstacles, quality);
  return quality;
}

}  // namespace luminav
