#include "services/localizer/integrity/slipping_wheels.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>

namespace luminav {
namespace {

constexpr std::array kGrips = {1.0, 0.5, 0.0};  // share of its own way by which a wheel moves the robot
constexpr double kDeviations = 3.0;             // of image noise

/// The step of a robot whose wheels moved it by so much [m], along its mean heading.
Pose2 step_of_wheels(double left, double right, double wheel_base) {
  const double distance = 0.5 * (left + right);
  const double turn = (right - left) / wheel_base;
  return {distance * std::cos(0.5 * turn), distance * std::sin(0.5 * turn), wrap_angle(turn)};
}

}  // namespace

bool is_beyond_slip(const CeilingLook& before, const CeilingLook& now, double wheel_base, double max) {
  const Pose2 step = before.odom_from_robot.inverse() * now.odom_from_robot;
  const double distance = step.x * std::cos(0.5 * step.theta) + step.y * std::sin(0.5 * step.theta);
  const double left = distance - 0.5 * wheel_base * step.theta;
  const double right = distance + 0.5 * wheel_base * step.theta;
  for (const double left_grip : kGrips) {
    for (const double right_grip : kGrips) {
      const Pose2 moved = step_of_wheels(left_grip * left, right_grip * right, wheel_base);
      const Eigen::Vector2d offset =
          now.robot_from_thing.position() - moved.inverse() * before.robot_from_thing.position();
      const double length = offset.norm();
      if (length <= max) {
        return false;
      }
      const Eigen::Vector2d direction = offset / length;
      const Eigen::Vector2d then = PointTransform(moved).turned(direction);
      const double variance = direction.dot(now.covariance * direction) + then.dot(before.covariance * then);
      if (length <= max + kDeviations * std::sqrt(variance)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace luminav
