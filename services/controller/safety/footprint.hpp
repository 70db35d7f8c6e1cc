#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/geometry/pose2.hpp"
#include "services/controller/safety/plane_points.hpp"

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
  /// Squared distance [m^2] of each point from the upright box around the outline: no point is nearer to the outline
  /// than to that; and the least of each `kBlock` of them. The last lanes of the points must be filled, and the squares
  /// have room for them.
  void measure_from_box(const PlanePoints& points, double* squared, double* min_of_block) const;
  static constexpr std::size_t kBlock = 64;
  /// How much farther [m] a point may be from the outline than from the box.
  [[nodiscard]] double max_inside_box() const { return max_inside_box_; }
  /// Farthest corner from the wheel axis [m]: what a turn on the spot sweeps.
  [[nodiscard]] double swept_radius() const { return swept_radius_; }

  static constexpr double kRounding = 1e-9;  // [m] far more than what a distance may be wrong by

 private:
  struct Edge {
    Eigen::Vector2d start;
    Eigen::Vector2d along;   // unit
    Eigen::Vector2d normal;  // unit, outward
    double length = 0.0;     // [m]
  };
  /// From the upright box around the outline [m^2].
  [[nodiscard]] double squared_from_box(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d beside = (box_low_ - point).cwiseMax(point - box_high_).cwiseMax(0.0);
    return beside.squaredNorm();
  }

  std::vector<Edge> edges_;
  double swept_radius_ = 0.0;                           // [m]
  double max_inside_box_ = 0.0;                         // [m]
  Eigen::Vector2d box_low_ = Eigen::Vector2d::Zero();   // [m] corners of the upright box around the outline
  Eigen::Vector2d box_high_ = Eigen::Vector2d::Zero();  // [m]
};

}  // namespace luminav
