#include "services/controller/safety/obstacles.hpp"

#include <algorithm>

namespace luminav {

void Obstacles::set(std::span<const ObstaclePoint> measured, std::span<const Eigen::Vector2d> walls, std::size_t zones,
                    ZoneEdge edge) {
  points_.assign(measured.begin(), measured.end());
  measured_ = measured.size();
  for (std::size_t i = 0; i < walls.size(); ++i) {
    points_.push_back(
        {.position = walls[i], .is_known = true, .zone_edge = i + zones >= walls.size() ? edge : ZoneEdge::kNone});
  }
  measure();
}

Obstacles Obstacles::seen_from(const Pose2& there_from_here) const {
  const PointTransform transform(there_from_here);
  Obstacles seen = *this;
  for (ObstaclePoint& point : seen.points_) {
    point.position = transform * point.position;
  }
  seen.measure();
  return seen;
}

void Obstacles::measure() {
  from_box_.clear();
  for (const ObstaclePoint& point : points_) {
    from_box_.push_back(footprint_.distance_from_box(point.position));
  }
}

template <class Counts>
double Obstacles::min_distance_of(double max, const Counts& counts) const {
  double min = max;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (from_box_[i] <= std::max(min, 0.0) && counts(points_[i])) {
      min = std::min(min, footprint_.distance(points_[i].position));
    }
  }
  return min;
}

double Obstacles::min_distance(double max) const {
  return min_distance_of(max, [](const ObstaclePoint&) { return true; });
}

double Obstacles::min_distance_ahead(double max) const {
  return min_distance_of(max, [](const ObstaclePoint& obstacle) { return obstacle.position.x() > 0.0; });
}

double Obstacles::min_unknown_distance(double max) const {
  return min_distance_of(max, [](const ObstaclePoint& obstacle) { return !obstacle.is_known; });
}

double Obstacles::min_news_distance(double max) const {
  return min_distance_of(max, [](const ObstaclePoint& obstacle) { return !obstacle.is_known && !obstacle.has_stood; });
}

}  // namespace luminav
