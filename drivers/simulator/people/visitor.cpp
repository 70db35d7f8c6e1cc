#include "drivers/simulator/people/visitor.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kGap = 1.0;         // [m] to the robot's middle, behind it
constexpr double kCrumb = 0.1;       // [m] between the points of a way
constexpr double kInTheWay = 1.5;    // [m] nearer to the robot's middle and before it he steps aside
constexpr double kLane = 0.7;        // [m] to each side of the robot's middle
constexpr double kAside = 0.8;       // [m/s]
constexpr double kOutOfSight = 6.0;  // [m]

}  // namespace

void Visitor::step(double dt, const Pose2& world_from_robot, const IsFree& is_free) {
  if (!follows()) {
    return;
  }
  const Vector2d robot = world_from_robot.position();
  if (trail_.empty() || (robot - trail_.back()).norm() > kCrumb) {
    trail_.push_back(robot);
  }
  if (followed_ < habit_.stops_after || (!habit_.leaves && stood_ >= habit_.stops_for)) {
    if (step_aside(dt, world_from_robot, is_free)) {
      trail_.assign(1, robot);  // it leads from here
    } else {
      follow(dt, robot, is_free);
    }
  } else if (habit_.leaves) {
    walk_back(dt);
  } else {
    stood_ += dt;
    step_aside(dt, world_from_robot, is_free);
  }
}

bool Visitor::step_aside(double dt, const Pose2& world_from_robot, const IsFree& is_free) {
  const Vector2d seen = world_from_robot.inverse() * position_;
  if (seen.x() < 0.0 || seen.norm() > kInTheWay) {
    return false;
  }
  if (std::abs(seen.y()) < kLane) {  // across its way on his own side, else before it; in a corner he can only stand
    const double side = seen.y() >= 0.0 ? 0.5 * kPi : -0.5 * kPi;
    walk(kAside * dt, world_from_robot.theta, {side, 0.5 * side, 0.0}, is_free);
  }
  return true;
}

std::optional<double> Visitor::walk(double step, double direction, std::initializer_list<double> turns,
                                    const IsFree& is_free) {
  for (const double turn : turns) {
    const Vector2d next = position_ + step * Vector2d(std::cos(direction + turn), std::sin(direction + turn));
    if (is_free(next)) {
      position_ = next;
      return turn;
    }
  }
  return std::nullopt;
}

void Visitor::follow(double dt, const Vector2d& robot, const IsFree& is_free) {
  if ((trail_.front() - robot).norm() < kGap) {
    return;  // near enough
  }
  const Vector2d offset = trail_.front() - position_;
  const double step = std::min(habit_.speed * dt, offset.norm());
  const double eighth = side_ * 0.25 * kPi;
  const std::optional<double> turn =
      walk(step, std::atan2(offset.y(), offset.x()),
           {0.0, eighth, 2.0 * eighth, 3.0 * eighth, -eighth, -2.0 * eighth, -3.0 * eighth}, is_free);
  followed_ += turn ? step : 0.0;
  side_ = turn && *turn * side_ < 0.0 ? -side_ : side_;  // once round a corner, not to and fro before it
  if (offset.norm() < kCrumb && trail_.size() > 1) {
    trail_.pop_front();
  }
  if (walked_.empty() || (position_ - walked_.back()).norm() > kCrumb) {
    walked_.push_back(position_);
  }
}

void Visitor::walk_back(double dt) {
  if (walked_.empty() || left_ > kOutOfSight) {
    gone_ = true;
    return;
  }
  const Vector2d offset = walked_.back() - position_;
  const double step = std::min(habit_.speed * dt, offset.norm());
  if (offset.norm() <= step) {
    position_ = walked_.back();
    walked_.pop_back();
  } else {
    position_ += step * offset.normalized();
  }
  left_ += step;
}

}  // namespace luminav
