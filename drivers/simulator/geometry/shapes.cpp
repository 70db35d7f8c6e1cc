#include "drivers/simulator/geometry/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luminav {
namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double squared_distance_to_segment(const Vector2d& point, const Vector2d& a, const Vector2d& b) {
  const Vector2d edge = b - a;
  const double length = edge.squaredNorm();
  const double along = length > 0.0 ? std::clamp((point - a).dot(edge) / length, 0.0, 1.0) : 0.0;
  return (point - a - along * edge).squaredNorm();
}

/// True when an edge of `a` has all of `b` on its outer side.
bool has_separating_edge(const Polygon& a, const Polygon& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vector2d& start = a[i];
    const Vector2d edge = a[(i + 1) % a.size()] - start;
    if (std::all_of(b.begin(), b.end(), [&](const Vector2d& corner) { return cross(edge, corner - start) < 0.0; })) {
      return true;
    }
  }
  return false;
}

double squared_distance_of_corners(const Polygon& corners, const Polygon& edges) {
  double min = std::numeric_limits<double>::infinity();
  for (const Vector2d& corner : corners) {
    for (std::size_t i = 0; i < edges.size(); ++i) {
      min = std::min(min, squared_distance_to_segment(corner, edges[i], edges[(i + 1) % edges.size()]));
    }
  }
  return min;
}

}  // namespace

Polygon rectangle(const Pose2& world_from_rectangle, double length, double width) {
  const double x = 0.5 * length;
  const double y = 0.5 * width;
  return transform(world_from_rectangle, {{-x, -y}, {x, -y}, {x, y}, {-x, y}});
}

Polygon transform(const Pose2& a_from_b, const Polygon& in_b) {
  const double c = std::cos(a_from_b.theta);
  const double s = std::sin(a_from_b.theta);
  Polygon in_a;
  in_a.reserve(in_b.size());
  for (const Vector2d& corner : in_b) {
    in_a.emplace_back(a_from_b.x + c * corner.x() - s * corner.y(), a_from_b.y + s * corner.x() + c * corner.y());
  }
  return in_a;
}

double distance(const Polygon& a, const Polygon& b) {
  if (!has_separating_edge(a, b) && !has_separating_edge(b, a)) {
    return 0.0;
  }
  return std::sqrt(std::min(squared_distance_of_corners(a, b), squared_distance_of_corners(b, a)));
}

double distance(const Polygon& polygon, const Vector2d& point) {
  bool inside = true;
  double min = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    inside = inside && cross(b - a, point - a) >= 0.0;
    min = std::min(min, squared_distance_to_segment(point, a, b));
  }
  return inside ? 0.0 : std::sqrt(min);
}

std::optional<RayHit> cast_ray(const Vector2d& origin, const Vector2d& direction, const Polygon& polygon) {
  // Cyrus and Beck 1978: the ray enters a convex polygon through the last edge whose outside it leaves.
  double enter = -std::numeric_limits<double>::infinity();
  double leave = std::numeric_limits<double>::infinity();
  Vector2d normal = Vector2d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    const Vector2d outward(edge.y(), -edge.x());
    const double height = outward.dot(origin - polygon[i]);
    const double rate = outward.dot(direction);
    if (rate == 0.0) {
      if (height > 0.0) {
        return std::nullopt;
      }
    } else if (rate < 0.0) {
      if (-height / rate > enter) {
        enter = -height / rate;
        normal = outward;
      }
    } else {
      leave = std::min(leave, -height / rate);
    }
  }
  if (enter > leave || enter < 0.0) {
    return std::nullopt;
  }
  return RayHit{enter, normal.normalized()};
}

std::optional<RayHit> cast_ray(const Vector2d& origin, const Vector2d& direction, const Disc& disc) {
  const Vector2d to_centre = disc.centre - origin;
  const double along = to_centre.dot(direction);
  const double squared_miss = to_centre.squaredNorm() - along * along;
  const double squared_radius = disc.radius * disc.radius;
  if (along <= 0.0 || squared_miss >= squared_radius || to_centre.squaredNorm() <= squared_radius) {
    return std::nullopt;
  }
  const double hit = along - std::sqrt(squared_radius - squared_miss);
  return RayHit{hit, (origin + hit * direction - disc.centre) / disc.radius};
}

}  // namespace luminav
