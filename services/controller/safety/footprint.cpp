#include "services/controller/safety/footprint.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace luminav {
Pose2 drive_arc(const DriveTwist& twist, double duration) {
  const double angle = twist.angular * duration;
  const double length = twist.linear * duration;
  // sin(x)/x and (1-cos(x))/x; below 1e-4 rad the chord is the arc to 1e-9
  const double forward = std::abs(angle) < 1e-4 ? 1.0 : std::sin(angle) / angle;
  const double left = std::abs(angle) < 1e-4 ? 0.5 * angle : (1.0 - std::cos(angle)) / angle;
  return {length * forward, length * left, wrap_angle(angle)};
}

Footprint::Footprint(const std::vector<Eigen::Vector2d>& corners) {
  if (corners.size() < 3) {
    throw std::invalid_argument("footprint: must have at least three corners");
  }
  box_low_ = box_high_ = corners.front();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    box_low_ = box_low_.cwiseMin(corners[i]);
    box_high_ = box_high_.cwiseMax(corners[i]);
    Edge edge;
    edge.start = corners[i];
    const Eigen::Vector2d step = corners[(i + 1) % corners.size()] - corners[i];
    edge.length = step.norm();
    edge.along = step / edge.length;
    edge.normal = {edge.along.y(), -edge.along.x()};
    edges_.push_back(edge);
    swept_radius_ = std::max(swept_radius_, corners[i].norm());
  }
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    if (edges_[i].normal.dot(edges_[(i + 1) % edges_.size()].along) > 1e-9) {
      throw std::invalid_argument("footprint: must be convex, its corners counter-clockwise");
    }
  }
}

double Footprint::distance(const Eigen::Vector2d& point) const {
  double inside = -std::numeric_limits<double>::infinity();
  double outside_squared = std::numeric_limits<double>::infinity();
  for (const Edge& edge : edges_) {
    const Eigen::Vector2d offset = point - edge.start;
    const double across = edge.normal.dot(offset);
    inside = std::max(inside, across);
    const double along = edge.along.dot(offset);
    const double beyond = along - std::clamp(along, 0.0, edge.length);
    outside_squared = std::min(outside_squared, across * across + beyond * beyond);
  }
  return inside <= 0.0 ? inside : std::sqrt(outside_squared);
}

}  // namespace luminav
