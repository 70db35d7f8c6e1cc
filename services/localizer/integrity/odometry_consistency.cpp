#include "services/localizer/integrity/odometry_consistency.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace luminav {
namespace {

constexpr std::array kGrips = {1.0, 0.5, 0.0};  // share of its own way by which a wheel moves the robot
constexpr double kDisplacement = 0.15;          // [m] that wheels, slipping or not, do not explain ...
constexpr double kDeviations = 3.0;             // ... beyond so many of image noise
constexpr double kMaxInOneImage = 0.6;          // of a motion: more is the centre of a cut fixture found elsewhere
constexpr std::int64_t kSpan = 600'000;         // [us] over which motions are compared
constexpr int kFrames = 3;                      // images in a row that show it: somebody moves the robot

/// The step of a robot whose wheels moved it by so much [m], along its mean heading.
Pose2 step_of_wheels(double left, double right, double wheel_base) {
  const double distance = 0.5 * (left + right);
  const double turn = (right - left) / wheel_base;
  return {distance * std::cos(0.5 * turn), distance * std::sin(0.5 * turn), wrap_angle(turn)};
}

}  // namespace

void OdometryConsistency::clear() {
  looks_.clear();
  run_ = 0;
}

bool OdometryConsistency::look(const SightingFrame& frame, const ObjectTracks& tracks, const Pose2& odom_from_robot) {
  const std::int64_t oldest = frame.utime - kSpan;
  std::erase_if(looks_, [&](const Look& look) { return look.utime < oldest; });
  const std::size_t first_of_now = looks_.size();
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const FixtureSighting& sighting = frame.sightings[i];
    looks_.push_back({frame.utime, tracks.seen(i).id, odom_from_robot, sighting.robot_from_fixture,
                      sighting.covariance.topLeftCorner<2, 2>()});
  }
  // What came into view just now cannot tell yet. Of the others all must: one that is seen wrongly now and then is not
  // to speak for them.
  bool can_tell = false;
  bool displaced = true;
  for (std::size_t i = first_of_now; i < looks_.size(); ++i) {
    const auto before =
        std::find_if(looks_.begin(), looks_.end(), [&](const Look& look) { return look.object == looks_[i].object; });
    if (frame.utime - before->utime >= kSpan / 2) {
      can_tell = true;
      displaced = displaced && is_beyond_slip(*before, looks_[i]) && moved_on(looks_[i]);
    }
  }
  if (can_tell) {
    run_ = displaced ? run_ + 1 : 0;
    told_utime_ = frame.utime;
  } else if (told_utime_ < oldest) {
    run_ = 0;
  }
  return run_ >= kFrames;
}

bool OdometryConsistency::is_beyond_slip(const Look& before, const Look& now) const {
  const Pose2 step = before.odom_from_robot.inverse() * now.odom_from_robot;
  const double distance = step.x * std::cos(0.5 * step.theta) + step.y * std::sin(0.5 * step.theta);
  const double left = distance - 0.5 * wheel_base_ * step.theta;
  const double right = distance + 0.5 * wheel_base_ * step.theta;
  for (const double left_grip : kGrips) {
    for (const double right_grip : kGrips) {
      const Pose2 moved = step_of_wheels(left_grip * left, right_grip * right, wheel_base_);
      const Eigen::Vector2d offset =
          now.robot_from_thing.position() - moved.inverse() * before.robot_from_thing.position();
      const double length = offset.norm();
      if (length <= kDisplacement) {
        return false;
      }
      const Eigen::Vector2d direction = offset / length;
      const Eigen::Vector2d then = PointTransform(moved).turned(direction);
      const double variance = direction.dot(now.covariance * direction) + then.dot(before.covariance * then);
      if (length <= kDisplacement + kDeviations * std::sqrt(variance)) {
        return false;
      }
    }
  }
  return true;
}

bool OdometryConsistency::moved_on(const Look& now) const {
  std::vector<Eigen::Vector2d> offsets;  // from where it is now, along the way of the wheels
  for (const Look& look : looks_) {
    if (look.object == now.object) {
      const Pose2 now_from_then = now.odom_from_robot.inverse() * look.odom_from_robot;
      offsets.push_back(now_from_then * look.robot_from_thing.position() - now.robot_from_thing.position());
    }
  }
  double longest = 0.0;
  for (std::size_t i = 1; i < offsets.size(); ++i) {
    longest = std::max(longest, (offsets[i] - offsets[i - 1]).norm());
  }
  return longest < kMaxInOneImage * offsets.front().norm();
}

}  // namespace luminav
