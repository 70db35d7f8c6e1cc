#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <vector>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// Twist of a differential drive, robot frame.
struct DriveTwist {
  double linear = 0.0;   // [m/s] forward
  double angular = 0.0;  // [rad/s] counter-clockwise
};

/// Where the robot is after driving a twist for a while [s]: start_from_end, an exact arc.
Pose2 drive_arc(const DriveTwist& twist, double duration);

/// Outline of the robot, a convex polygon in its own frame.
class Footprint {
 public:
  /// Corners [m] counter-clockwise. Throws std::invalid_argument unless convex with at least three of them.
  explicit Footprint(const std::vector<Eigen::Vector2d>& corners);

  /// Distance [m] from the outline to a point in the robot frame; negative inside.
  [[nodiscard]] double distance(const Eigen::Vector2d& point) const;
  /// True only of points at least `distance` [m] away, though not of all of them: cheap.
  [[nodiscard]] bool is_surely_beyond(const Eigen::Vector2d& point, double distance) const {
    const double reach = distance + kRounding;
    return reach > 0.0 && squared_from_box(point) > reach * reach;
  }
  /// The least `distance` of those things that count, or `most`. Things have a `position` [m] in the robot frame.
  template <typename Things, typename Counts>
  [[nodiscard]] double least_distance(const Things& things, double most, const Counts& counts) const {
    // the one nearest to the box first: then hardly another needs more than a glance
    double least_square = std::numeric_limits<double>::infinity();
    double second_square = least_square;
    const Eigen::Vector2d* nearest = nullptr;
    for (const auto& thing : things) {
      const double square = squared_from_box(thing.position);
      if (square < second_square && counts(thing)) {
        second_square = std::max(square, least_square);
        nearest = square < least_square ? &thing.position : nearest;
        least_square = std::min(square, least_square);
      }
    }
    double least = nearest == nullptr ? most : std::min(most, distance(*nearest));
    if (least > 0.0 && second_square > (least + kRounding) * (least + kRounding)) {
      return least;
    }
    for (const auto& thing : things) {
      if (!is_surely_beyond(thing.position, least) && counts(thing)) {
        least = std::min(least, distance(thing.position));
      }
    }
    return least;
  }
  /// Farthest corner from the wheel axis [m]: what a turn on the spot sweeps.
  [[nodiscard]] double swept_radius() const { return swept_radius_; }

 private:
  struct Edge {
    Eigen::Vector2d start;
    Eigen::Vector2d along;   // unit
    Eigen::Vector2d normal;  // unit, outward
    double length = 0.0;     // [m]
  };
  static constexpr double kRounding = 1e-9;  // [m] far more than what a distance may be wrong by

  /// From the upright box around the outline, which no point is nearer to the outline than: [m^2].
  [[nodiscard]] double squared_from_box(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d beside = (box_low_ - point).cwiseMax(point - box_high_).cwiseMax(0.0);
    return beside.squaredNorm();
  }

  std::vector<Edge> edges_;
  double swept_radius_ = 0.0;                           // [m]
  Eigen::Vector2d box_low_ = Eigen::Vector2d::Zero();   // [m] corners of the upright box around the outline
  Eigen::Vector2d box_high_ = Eigen::Vector2d::Zero();  // [m]
};

}  // namespace luminav
