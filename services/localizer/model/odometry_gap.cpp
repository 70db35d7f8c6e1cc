#include "services/localizer/model/odometry_gap.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kFastest = 3.0;              // [m/s] odometry that runs faster has jumped
constexpr double kLongest = 2.4;              // [s] a watchdog's 2 s and half the time braking takes
constexpr double kToKidnap = 6.0;             // [s] nobody lifts a robot, takes it elsewhere and sets it down in less
constexpr double kAcceleration = 1.0;         // [m/s^2] braking hard
constexpr double kAngularAcceleration = 2.1;  // [rad/s^2] beginning to turn, or ending
const Eigen::Vector3d kAtRest{0.04, 0.04, 0.03};  // [m^2, m^2, rad^2] left open however short the gap is

Pose2 arc(double linear, double angular, double time) {
  const double turn = angular * time;
  const double chord = linear * time * (std::abs(turn) < 1e-6 ? 1.0 : std::sin(0.5 * turn) / (0.5 * turn));
  return {chord * std::cos(0.5 * turn), chord * std::sin(0.5 * turn), wrap_angle(turn)};
}

}  // namespace

std::string find_gap(const OdometryReading& last, const OdometryReading& next) {
  const double farthest = 0.3 + kFastest * 1e-6 * static_cast<double>(next.utime - last.utime);
  return next.session != last.session                                      ? "the odometry began anew"
         : distance(next.odom_from_robot, last.odom_from_robot) > farthest ? "the odometry jumped"
                                                                           : "";
}

OdometryGap odometry_gap(const OdometryReading& last, const OdometryReading& next) {
  const double elapsed = 1e-6 * static_cast<double>(next.utime - last.utime);
  const double longest = std::clamp(elapsed, 0.0, kLongest);
  OdometryGap gap;
  gap.may_be_kidnapped = elapsed > kToKidnap;
  gap.step = arc(last.linear, last.angular, 0.5 * longest);
  // any time up to the longest is as likely: along the arc the end is known as well as that
  const double sigma = longest / std::sqrt(12.0);
  const Eigen::Vector3d velocity(last.linear * std::cos(gap.step.theta), last.linear * std::sin(gap.step.theta),
                                 last.angular);
  gap.noise = sigma * sigma * velocity * velocity.transpose();
  gap.noise.diagonal() += kAtRest;
  return gap;
}

OdometryGap extrapolate(const OdometryReading& newest, std::int64_t utime) {
  const double time = 1e-6 * static_cast<double>(utime - newest.utime);
  OdometryGap gap;
  gap.step = arc(newest.linear, newest.angular, time);
  const Eigen::Vector3d error = 0.5 * time * time * Eigen::Vector3d(kAcceleration, 0.0, kAngularAcceleration);
  gap.noise = error.cwiseProduct(error).asDiagonal();
  return gap;
}

}  // namespace luminav
