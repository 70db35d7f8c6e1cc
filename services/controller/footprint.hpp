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
    constexpr double kRounding = 1e-9;
    const double reach = distance + swept_radius_ + kRounding;
    return reach > 0.0 && point.squaredNorm() > reach * reach;
  }
  /// The least `distance` of those things that count, or `most`. Things have a `position` [m] in the robot frame.
  template <typename Things, typename Counts>
  [[nodiscard]] double least_distance(const Things& things, double most, const Counts& counts) const {
    // the one nearest to the wheel axis first: then hardly another needs more than a glance
    double least_square = std::numeric_limits<double>::infinity();
    const Eigen::Vector2d* nearest = nullptr;
    for (const auto& thing : things) {
      const double square = thing.position.squaredNorm();
      if (square < least_square && counts(thing)) {
        least_square = square;
        nearest = &thing.position;
      }
    }
    double least = nearest == nullptr ? most : std::min(most, distance(*nearest));
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
  std::vector<Edge> edges_;
  double swept_radius_ = 0.0;  // [m]
};

}  // namespace luminav
