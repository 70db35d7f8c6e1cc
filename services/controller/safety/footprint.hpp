#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// Twist of a differential drive, robot frame.
struct DriveTwist {
  double linear = 0.0;   // [m/s] forward
  double angular = 0.0;  // [rad/s] counter-clockwise
};

/// Pose of the robot after driving a twist for a while [s]: start_from_end, an exact arc.
Pose2 drive_arc(const DriveTwist& twist, double duration);

/// Outline of the robot, a convex polygon in its own frame.
class Footprint {
 public:
  /// Corners [m] counter-clockwise. Throws std::invalid_argument unless convex with at least three of them.
  explicit Footprint(const std::vector<Eigen::Vector2d>& corners);

  /// Distance [m] from the outline to a point in the robot frame; negative inside.
  [[nodiscard]] double distance(const Eigen::Vector2d& point) const;
  /// Distance [m] from the upright box around the outline: no point is nearer to the outline than to that. Cheap.
  [[nodiscard]] double distance_from_box(const Eigen::Vector2d& point) const {
    return (box_low_ - point).cwiseMax(point - box_high_).cwiseMax(0.0).norm();
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
  double swept_radius_ = 0.0;                           // [m]
  Eigen::Vector2d box_low_ = Eigen::Vector2d::Zero();   // [m] corners of the upright box around the outline
  Eigen::Vector2d box_high_ = Eigen::Vector2d::Zero();  // [m]
};

}  // namespace luminav
