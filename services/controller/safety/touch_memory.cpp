#include "services/controller/safety/touch_memory.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kKeep = 60.0;     // [s] a touch is remembered
constexpr double kGap = 0.03;      // [m] from the outline to what it touched: wheels stall, they do not measure
constexpr double kSpacing = 0.06;  // [m] between the points that stand for it
constexpr double kDriving = 0.02;  // [m/s] slower is no direction

}  // namespace

TouchMemory::TouchMemory(const RobotDescription& robot) {
  for (const Eigen::Vector2d& corner : robot.footprint) {
    front_ = std::max(front_, corner.x());
    rear_ = std::min(rear_, corner.x());
    half_width_ = std::max(half_width_, std::abs(corner.y()));
  }
}

void TouchMemory::add(std::int64_t now, const Pose2& odom_from_robot, const DriveTwist& twist) {
  if (std::abs(twist.linear) < kDriving) {
    return;
  }
  if (touches_.size() >= kMax) {
    touches_.erase(touches_.begin());
  }
  Touch touch{now, {}};
  const double x = twist.linear > 0.0 ? front_ + kGap : rear_ - kGap;
  const int steps = static_cast<int>(std::ceil(2.0 * half_width_ / kSpacing));
  for (int i = 0; i <= steps; ++i) {
    touch.points_in_odom.push_back(odom_from_robot * Eigen::Vector2d(x, half_width_ * (2.0 * i / steps - 1.0)));
  }
  touches_.push_back(std::move(touch));
}

void TouchMemory::append(std::int64_t now, const Pose2& odom_from_robot, std::vector<ObstaclePoint>& obstacles) const {
  const Pose2 robot_from_odom = odom_from_robot.inverse();
  for (const Touch& touch : touches_) {
    if (seconds_between(touch.utime, now) > kKeep || now < touch.utime) {
      continue;
    }
    for (const Eigen::Vector2d& point : touch.points_in_odom) {
      ObstaclePoint obstacle;
      obstacle.position = robot_from_odom * point;
      obstacle.has_stood = true;
      obstacles.push_back(obstacle);
    }
  }
}

}  // namespace luminav
