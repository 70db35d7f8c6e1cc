#include "services/localizer/integrity/motion_outlier.hpp"

#include <algorithm>

namespace luminav {
namespace {

constexpr double kRushSpeed = 0.4;     // [m/s] of a thing past the robot, beyond what wheels and noise explain
constexpr double kFarthestStep = 0.5;  // [m] between two images of one thing, beside what the wheels say
constexpr double kLongest = 0.25;      // [s] between them
constexpr double kMaxUneven = 0.5;     // two steps of a motion differ by less, as a share of the longer one

/// Where it is now, beside where the wheels say [m], robot frame of now.
Eigen::Vector2d step_between(const CeilingLook& before, const CeilingLook& now) {
  const Pose2 now_from_then = now.odom_from_robot.inverse() * before.odom_from_robot;
  return now.robot_from_thing.position() - now_from_then * before.robot_from_thing.position();
}

}  // namespace

bool MotionOutlier::look(const SightingFrame& frame, const Pose2& odom_from_robot) {
  before_.swap(now_);
  now_.clear();
  bool any_rushes = false;
  bool any_stays = false;
  for (const FixtureSighting& sighting : frame.sightings) {
    Thing& thing = now_.emplace_back();
    thing.look = {frame.utime, odom_from_robot, sighting.robot_from_fixture, sighting.covariance.topLeftCorner<2, 2>()};
    const Thing* before = find_before(thing.look);
    if (before == nullptr) {
      continue;
    }
    const Eigen::Vector2d step = step_between(before->look, thing.look);
    const double time = 1e-6 * static_cast<double>(frame.utime - before->look.utime);
    thing.step = step;
    thing.is_fast = is_beyond_slip(before->look, thing.look, wheel_base_, kRushSpeed * time);
    if (before->step) {
      const bool is_even = (step - *before->step).norm() < kMaxUneven * std::max(step.norm(), before->step->norm());
      const bool rushes = thing.is_fast && before->is_fast && is_even;
      any_rushes = any_rushes || rushes;
      any_stays = any_stays || !rushes;
    }
  }
  return any_rushes && !any_stays;
}

const MotionOutlier::Thing* MotionOutlier::find_before(const CeilingLook& now) const {
  const Thing* nearest = nullptr;
  double min = kFarthestStep;
  for (const Thing& thing : before_) {
    const double length = step_between(thing.look, now).norm();
    if (length < min && 1e-6 * static_cast<double>(now.utime - thing.look.utime) < kLongest) {
      min = length;
      nearest = &thing;
    }
  }
  return nearest;
}

}  // namespace luminav
