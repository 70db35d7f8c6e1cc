#include "drivers/simulator/world/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kLegRadius = 0.02;      // [m] of chairs and tables
constexpr double kDoorThickness = 0.04;  // [m]
constexpr double kNormalWindow = 0.20;   // [m] of wall round a point that decides where it faces
constexpr int kExactCells = 4;           // nearer walls are measured cell by cell

void keep_nearer(std::optional<SurfaceHit>& nearest, const std::optional<RayHit>& hit, Surface surface, double range) {
  if (hit && hit->distance <= (nearest ? nearest->distance : range)) {
    nearest = SurfaceHit{hit->distance, hit->normal, surface};
  }
}

/// Lower bound of the distance between an outline and a circle round something [m].
double distance_bound(const Polygon& outline, const Vector2d& centre, double radius) {
  double min = std::numeric_limits<double>::infinity();
  double longest_edge = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    min = std::min(min, (outline[i] - centre).norm());
    longest_edge = std::max(longest_edge, (outline[(i + 1) % outline.size()] - outline[i]).norm());
  }
  return min - 0.5 * longest_edge - radius;
}

}  // namespace

double Separation::nearest() const {
  return *std::min_element(of.begin(), of.end());
}

Scene::Scene(const WorldTruth& truth) : walls_(&truth.walls) {
  if (!truth.walls.cells.empty()) {
    wall_field_ = distance_to_walls(truth.walls);
  }
  for (const Obstacle& obstacle : truth.obstacles) {
    bodies_.push_back(make_body(obstacle));
    if (obstacle.kind != ObstacleKind::kBox) {
      bodies_.back().hard_index = hard_count_++;
    }
  }
  for (const Door& door : truth.building.doors) {
    doors_.push_back({rectangle(door.world_from_door, door.width, kDoorThickness), false});
  }
  for (const WalkingPerson& person : truth.people) {
    people_.push_back({person.waypoints.front(), kPersonRadius});
  }
}

Scene::Body Scene::make_body(const Obstacle& obstacle) {
  Body body;
  body.kind = obstacle.kind;
  body.outline = rectangle(*obstacle.world_from_obstacle, obstacle.length, obstacle.width);
  body.centre = obstacle.world_from_obstacle->position();
  body.radius = 0.5 * std::hypot(obstacle.length, obstacle.width);
  const Polygon feet = rectangle(*obstacle.world_from_obstacle, std::max(0.0, obstacle.length - 2.0 * kLegRadius),
                                 std::max(0.0, obstacle.width - 2.0 * kLegRadius));
  for (std::size_t i = 0; i < feet.size(); ++i) {
    body.legs[i] = {feet[i], kLegRadius};
  }
  return body;
}

Separation Scene::separation(const Polygon& outline) const {
  Separation result;
  const auto keep = [&result](SolidKind kind, double distance) {
    double& value = result.of[static_cast<std::size_t>(kind)];
    value = std::min(value, std::max(0.0, distance));
  };
  keep(SolidKind::kWall, wall_distance(outline));
  for (const DoorLeaf& door : doors_) {
    if (door.closed) {
      keep(SolidKind::kWall, distance(outline, door.leaf));
    }
  }
  for (const Body& body : bodies_) {
    const SolidKind kind = body.kind == ObstacleKind::kBox ? SolidKind::kBox : SolidKind::kHard;
    if (distance_bound(outline, body.centre, body.radius) > result.to(kind)) {
      continue;
    }
    if (body.kind != ObstacleKind::kLegs) {
      keep(kind, distance(outline, body.outline));
      continue;
    }
    for (const Disc& leg : body.legs) {
      keep(kind, distance(outline, leg.centre) - leg.radius);
    }
  }
  keep(SolidKind::kPerson, person_distance(outline));
  return result;
}

double Scene::person_distance(const Polygon& outline) const {
  double min = Separation::kNoneNear;
  for (const Disc& person : people_) {
    if (distance_bound(outline, person.centre, person.radius) <= min) {
      min = std::min(min, distance(outline, person.centre) - person.radius);
    }
  }
  return std::max(0.0, min);
}

double Scene::wall_distance(const Polygon& outline) const {
  if (walls_->cells.empty()) {
    return Separation::kNoneNear;
  }
  const double resolution = walls_->geometry.resolution;
  double min = DistanceField::kFar;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2d& a = outline[i];
    const Vector2d edge = outline[(i + 1) % outline.size()] - a;
    const int steps = 1 + static_cast<int>(edge.norm() / std::max(resolution, 0.05));
    for (int j = 0; j < steps; ++j) {
      min = std::min(min, wall_field_.at(Vector2d(a + edge * (static_cast<double>(j) / steps))));
    }
  }
  if (min > kExactCells * resolution) {
    return min;
  }
  // the field and the sampling are each wrong by less than a cell and a half
  const double reach = min + 3.0 * resolution;
  return std::min(exact_wall_distance(outline, reach), reach);
}

double Scene::exact_wall_distance(const Polygon& outline, double reach) const {
  const GridGeometry& geometry = walls_->geometry;
  Vector2d min = outline.front();
  Vector2d max = outline.front();
  for (const Vector2d& corner : outline) {
    min = min.cwiseMin(corner);
    max = max.cwiseMax(corner);
  }
  const Cell first = geometry.cell_at(min - Vector2d::Constant(reach));
  const Cell last = geometry.cell_at(max + Vector2d::Constant(reach));
  const double half = 0.5 * geometry.resolution;
  Polygon square(4);
  double result = reach;
  for (int row = first.row; row <= last.row; ++row) {
    for (int column = first.column; column <= last.column; ++column) {
      if (!is_wall({column, row})) {
        continue;
      }
      const Vector2d centre = geometry.centre_of({column, row});
      if (distance_bound(outline, centre, 1.42 * half) >= result) {
        continue;
      }
      square = {centre + Vector2d(-half, -half), centre + Vector2d(half, -half), centre + Vector2d(half, half),
                centre + Vector2d(-half, half)};
      result = std::min(result, distance(outline, square));
      if (result <= 0.0) {
        return 0.0;
      }
    }
  }
  return result;
}

std::optional<SurfaceHit> Scene::cast_ray(const Vector2d& origin, const Vector2d& direction, double range,
                                          const std::vector<char>& heard) const {
  std::optional<SurfaceHit> nearest = cast_ray_at_walls(origin, direction, range);
  for (const DoorLeaf& door : doors_) {
    if (door.closed) {
      keep_nearer(nearest, luminav::cast_ray(origin, direction, door.leaf), Surface::kSmooth, range);
    }
  }
  for (const Body& body : bodies_) {
    if ((body.centre - origin).squaredNorm() > std::pow(range + body.radius, 2)) {
      continue;
    }
    if (body.kind == ObstacleKind::kBox) {
      keep_nearer(nearest, luminav::cast_ray(origin, direction, body.outline), Surface::kSmooth, range);
    } else if (body.kind == ObstacleKind::kGlass) {
      keep_nearer(nearest, luminav::cast_ray(origin, direction, body.outline), Surface::kGlass, range);
    } else if (heard[body.hard_index] != 0) {
      for (const Disc& leg : body.legs) {
        keep_nearer(nearest, luminav::cast_ray(origin, direction, leg), Surface::kThin, range);
      }
    }
  }
  for (const Disc& person : people_) {
    keep_nearer(nearest, luminav::cast_ray(origin, direction, person), Surface::kCloth, range);
  }
  return nearest;
}

std::optional<SurfaceHit> Scene::cast_ray_at_walls(const Vector2d& origin, const Vector2d& direction,
                                                   double range) const {
  // Amanatides and Woo 1987: from cell to cell along the ray.
  if (walls_->cells.empty()) {
    return std::nullopt;
  }
  const GridGeometry& geometry = walls_->geometry;
  Cell cell = geometry.cell_at(origin);
  const int step_x = direction.x() > 0.0 ? 1 : -1;
  const int step_y = direction.y() > 0.0 ? 1 : -1;
  const double infinity = std::numeric_limits<double>::infinity();
  const double per_column = direction.x() != 0.0 ? geometry.resolution / std::abs(direction.x()) : infinity;
  const double per_row = direction.y() != 0.0 ? geometry.resolution / std::abs(direction.y()) : infinity;
  const Vector2d in_cell = (origin - geometry.centre_of(cell)) / geometry.resolution + Vector2d(0.5, 0.5);
  double next_column = direction.x() != 0.0 ? per_column * (step_x > 0 ? 1.0 - in_cell.x() : in_cell.x()) : infinity;
  double next_row = direction.y() != 0.0 ? per_row * (step_y > 0 ? 1.0 - in_cell.y() : in_cell.y()) : infinity;
  while (true) {
    const bool along_x = next_column < next_row;
    const double travelled = along_x ? next_column : next_row;
    if (travelled > range) {
      return std::nullopt;
    }
    if (along_x) {
      cell.column += step_x;
      next_column += per_column;
    } else {
      cell.row += step_y;
      next_row += per_row;
    }
    if (is_wall(cell)) {
      Vector2d normal = wall_normal(origin + (travelled - 0.5 * geometry.resolution) * direction);
      if (normal.dot(direction) >= 0.0) {
        normal = along_x ? Vector2d(-step_x, 0.0) : Vector2d(0.0, -step_y);
      }
      return SurfaceHit{travelled, normal, Surface::kSmooth};
    }
  }
}

Vector2d Scene::wall_normal(const Vector2d& point) const {
  // From the centre of mass of the wall nearby to the point: smooth for walls that the grid shows as stairs, and along
  // the bisector in a corner, which throws sound back.
  const GridGeometry& geometry = walls_->geometry;
  const int reach = std::max(1, static_cast<int>(std::lround(kNormalWindow / geometry.resolution)));
  const Cell middle = geometry.cell_at(point);
  const Vector2d centre = geometry.centre_of(middle);
  Vector2d sum = Vector2d::Zero();
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      const Cell cell{middle.column + column, middle.row + row};
      if (row * row + column * column <= reach * reach && is_wall(cell)) {
        // nearer cells count more, so that the far side of a thin wall does not
        const Vector2d offset = centre - geometry.centre_of(cell);
        sum += offset / (offset.squaredNorm() + geometry.resolution * geometry.resolution);
      }
    }
  }
  const double length = sum.norm();
  return length > 0.0 ? Vector2d(sum / length) : Vector2d::Zero();
}

void Scene::edges_near(const Vector2d& point, double range, std::vector<Edge>& edges) const {
  edges.clear();
  for (const Body& body : bodies_) {
    if (body.kind != ObstacleKind::kBox || (body.centre - point).squaredNorm() > std::pow(range + body.radius, 2)) {
      continue;
    }
    for (const Vector2d& corner : body.outline) {
      edges.push_back({corner});
    }
  }
}

}  // namespace luminav
