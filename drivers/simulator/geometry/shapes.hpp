#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// Corners of a convex polygon, counter-clockwise.
using Polygon = std::vector<Eigen::Vector2d>;

struct Disc {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // [m]
  double radius = 0.0;                               // [m]
};

/// Rectangle round a pose, length along its x.
Polygon rectangle(const Pose2& world_from_rectangle, double length, double width);
Polygon transform(const Pose2& a_from_b, const Polygon& in_b);

/// [m], 0 when they touch or overlap.
double distance(const Polygon& a, const Polygon& b);
double distance(const Polygon& polygon, const Eigen::Vector2d& point);

/// Where a ray meets a surface.
struct RayHit {
  double distance = 0.0;                             // [m]
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();  // unit, out of the surface
};

/// Nearest point of the border that a ray enters through; `direction` is a unit vector. Nothing when the ray misses
/// or starts inside.
std::optional<RayHit> cast_ray(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction, const Polygon& polygon);
std::optional<RayHit> cast_ray(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction, const Disc& disc);

}  // namespace luminav
