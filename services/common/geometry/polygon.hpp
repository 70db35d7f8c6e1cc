#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace luminav {

/// Corners [m] of an area, in order, either way round; the last is joined to the first.
using Polygon = std::vector<Eigen::Vector2d>;

/// True if the point is inside, by the number of edges that a ray towards +x crosses.
inline bool contains(const Polygon& polygon, const Eigen::Vector2d& point) {
  bool inside = false;
  for (std::size_t i = 0, before = polygon.size() - 1; i < polygon.size(); before = i++) {
    const Eigen::Vector2d& a = polygon[before];
    const Eigen::Vector2d& b = polygon[i];
    if ((a.y() > point.y()) != (b.y() > point.y()) &&
        point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) {
      inside = !inside;
    }
  }
  return inside;
}

/// Distance [m] from a point to the nearest edge, from inside and outside alike.
inline double distance_to_edge(const Polygon& polygon, const Eigen::Vector2d& point) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d along = polygon[(i + 1) % polygon.size()] - a;
    const double part = std::clamp((point - a).dot(along) / std::max(1e-12, along.squaredNorm()), 0.0, 1.0);
    least = std::min(least, (point - a - part * along).norm());
  }
  return least;
}

/// True if no edge crosses or touches another one but its neighbours at their common corner.
inline bool is_simple(const Polygon& polygon) {
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); };
  const auto side = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return cross(b - a, c - a);
  };
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % n];
    for (std::size_t k = i + 2; k < n; ++k) {
      if ((k + 1) % n == i) {
        continue;  // neighbours
      }
      const Eigen::Vector2d& c = polygon[k];
      const Eigen::Vector2d& d = polygon[(k + 1) % n];
      if (side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0) {
        return false;
      }
    }
  }
  return n >= 3;
}

/// Points along all edges, at most `spacing` [m] apart, corners included.
inline std::vector<Eigen::Vector2d> edge_points(const Polygon& polygon, double spacing) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d along = polygon[(i + 1) % polygon.size()] - a;
    const int pieces = std::max(1, static_cast<int>(std::ceil(along.norm() / spacing)));
    for (int k = 0; k < pieces; ++k) {
      points.push_back(a + along * (static_cast<double>(k) / pieces));
    }
  }
  return points;
}

/// How deep [m] two polygons reach into each other, from points on their edges at most `spacing` [m] apart; 0 = they do
/// not overlap.
inline double overlap_depth(const Polygon& a, const Polygon& b, double spacing) {
  double depth = 0.0;
  const auto probe = [&](const Polygon& edges, const Polygon& other) {
    for (const Eigen::Vector2d& point : edge_points(edges, spacing)) {
      if (contains(other, point)) {
        depth = std::max(depth, distance_to_edge(other, point));
      }
    }
  };
  probe(a, b);
  probe(b, a);  // a corner of the other one
  return depth;
}

}  // namespace luminav
