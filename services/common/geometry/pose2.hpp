#pragma once

#include <Eigen/Core>
#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav {

/// A planar pose `parent_from_child`: maps points of the child frame to the parent frame.
struct Pose2 {
  double x = 0.0;      // [m]
  double y = 0.0;      // [m]
  double theta = 0.0;  // [rad] (-pi, pi]

  [[nodiscard]] Eigen::Vector2d position() const { return {x, y}; }

  /// child_from_parent.
  [[nodiscard]] Pose2 inverse() const {
    const double c = std::cos(theta);
    const double s = std::sin(theta);
    return {-(c * x + s * y), -(-s * x + c * y), wrap_angle(-theta)};
  }
};

/// a_from_c = a_from_b * b_from_c.
inline Pose2 operator*(const Pose2& a_from_b, const Pose2& b_from_c) {
  const double c = std::cos(a_from_b.theta);
  const double s = std::sin(a_from_b.theta);
  return {a_from_b.x + c * b_from_c.x - s * b_from_c.y, a_from_b.y + s * b_from_c.x + c * b_from_c.y,
          wrap_angle(a_from_b.theta + b_from_c.theta)};
}

/// p_in_a = a_from_b * p_in_b.
inline Eigen::Vector2d operator*(const Pose2& a_from_b, const Eigen::Vector2d& p_in_b) {
  const double c = std::cos(a_from_b.theta);
  const double s = std::sin(a_from_b.theta);
  return {a_from_b.x + c * p_in_b.x() - s * p_in_b.y(), a_from_b.y + s * p_in_b.x() + c * p_in_b.y()};
}

/// A pose that maps many points, with the same results as the pose itself: sine and cosine are taken once.
class PointTransform {
 public:
  explicit PointTransform(const Pose2& a_from_b)
      : x_(a_from_b.x), y_(a_from_b.y), c_(std::cos(a_from_b.theta)), s_(std::sin(a_from_b.theta)) {}
  /// Equals the transform of `b_from_a.inverse()`, whose sine and cosine are these.
  static PointTransform inverse_of(const Pose2& b_from_a) {
    PointTransform transform(b_from_a);
    transform.s_ = -transform.s_;
    const Eigen::Vector2d origin = transform.turned(b_from_a.position());
    transform.x_ = -origin.x();
    transform.y_ = -origin.y();
    return transform;
  }

  [[nodiscard]] Eigen::Vector2d operator*(const Eigen::Vector2d& p_in_b) const {
    return {x_ + c_ * p_in_b.x() - s_ * p_in_b.y(), y_ + s_ * p_in_b.x() + c_ * p_in_b.y()};
  }
  /// Maps a direction: turns it only.
  [[nodiscard]] Eigen::Vector2d turned(const Eigen::Vector2d& in_b) const {
    return {c_ * in_b.x() - s_ * in_b.y(), s_ * in_b.x() + c_ * in_b.y()};
  }

 private:
  double x_;
  double y_;
  double c_;
  double s_;
};

/// The pose at a fraction between two poses (fractions outside 0..1 extrapolate); the heading takes the shorter turn.
inline Pose2 interpolate(const Pose2& from, const Pose2& to, double fraction) {
  return {from.x + fraction * (to.x - from.x), from.y + fraction * (to.y - from.y),
          wrap_angle(from.theta + fraction * wrap_angle(to.theta - from.theta))};
}

inline double distance(const Pose2& a, const Pose2& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// Less than a distance [m] and a turn [rad] lie between two poses.
inline bool is_near(const Pose2& a, const Pose2& b, double apart, double turned) {
  return distance(a, b) < apart && std::abs(wrap_angle(a.theta - b.theta)) < turned;
}

}  // namespace luminav
