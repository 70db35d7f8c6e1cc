#include "services/controller/safety/footprint.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

/// Squares of how far points lie outside a box, whole lanes of them, and the least of each block.
LUMINAV_VECTOR_CLONES
void square_beside(const PlanePoints& points, const Eigen::Vector2d& low, const Eigen::Vector2d& high, double* squared,
                   double* min_of_block) {
  // by value: for all the compiler knows, a square that is written may be part of what is referred to
  const Doubles low_x = Doubles{} + low.x();
  const Doubles low_y = Doubles{} + low.y();
  const Doubles high_x = Doubles{} + high.x();
  const Doubles high_y = Doubles{} + high.y();
  const double* const all_x = points.x();
  const double* const all_y = points.y();
  const std::size_t size = points.size();
  for (std::size_t first = 0; first < size; first += Footprint::kBlock) {
    Doubles min = Doubles{} + std::numeric_limits<double>::infinity();
    const std::size_t end = std::min(first + Footprint::kBlock, size);
    for (std::size_t i = first; i < end; i += kLanes) {
      Doubles x;
      Doubles y;
      load(all_x + i, x);
      load(all_y + i, y);
      const Doubles left = low_x - x;
      const Doubles right = x - high_x;
      const Doubles below = low_y - y;
      const Doubles above = y - high_y;
      const Doubles nearer_x = left > right ? left : right;
      const Doubles nearer_y = below > above ? below : above;
      const Doubles beside_x = nearer_x > 0.0 ? nearer_x : Doubles{};
      const Doubles beside_y = nearer_y > 0.0 ? nearer_y : Doubles{};
      const Doubles sum = beside_x * beside_x + beside_y * beside_y;
      std::memcpy(squared + i, &sum, sizeof(sum));
      min = sum < min ? sum : min;
    }
    *min_of_block++ = std::min(std::min(min[0], min[1]), std::min(min[2], min[3]));
  }
}

}  // namespace

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
  for (const double x : {box_low_.x(), box_high_.x()}) {
    for (const double y : {box_low_.y(), box_high_.y()}) {
      max_inside_box_ = std::max(max_inside_box_, distance({x, y}));
    }
  }
}

void Footprint::measure_from_box(const PlanePoints& points, double* squared, double* min_of_block) const {
  square_beside(points, box_low_, box_high_, squared, min_of_block);
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
