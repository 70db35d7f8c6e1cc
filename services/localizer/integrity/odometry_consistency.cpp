#include "services/localizer/integrity/odometry_consistency.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "services/localizer/integrity/wheels_at_rest.hpp"

namespace luminav {
namespace {

constexpr double kMaxInOneImage = 0.6;  // of a motion: more is the centre of a cut fixture found elsewhere

}  // namespace

void OdometryConsistency::clear() {
  looks_.clear();
  run_ = 0;
}

bool OdometryConsistency::look(const SightingFrame& frame, const std::vector<int>& objects, const ObjectTracks& tracks,
                               const Pose2& odom_from_robot) {
  const auto span = static_cast<std::int64_t>(1e6 * rules_.displacement_time);
  const std::int64_t oldest = frame.utime - span;
  std::erase_if(looks_, [&](const Look& look) { return look.utime < oldest; });
  if (!are_wheels_at_rest(odom_at_frame_, odom_from_robot)) {
    at_rest_since_ = frame.utime;
  }
  odom_at_frame_ = odom_from_robot;
  const std::size_t first_of_now = looks_.size();
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const FixtureSighting& sighting = frame.sightings[i];
    looks_.push_back(
        {{frame.utime, odom_from_robot, sighting.robot_from_fixture, sighting.covariance.topLeftCorner<2, 2>()},
         tracks.objects()[static_cast<std::size_t>(objects[i])].id});
  }
  // What is in view for longest tells, and of things that came at once all must: one that is seen wrongly now and then
  // is not to speak for the others.
  std::int64_t since = frame.utime;
  bool displaced = false;
  for (std::size_t i = first_of_now; i < looks_.size(); ++i) {
    const auto before =
        std::find_if(looks_.begin(), looks_.end(), [&](const Look& look) { return look.object == looks_[i].object; });
    if (before->utime <= since) {
      displaced = (before->utime < since || displaced) && is_displaced(*before, looks_[i]) && moved_on(looks_[i]);
      since = before->utime;
    }
  }
  // what came into view just now cannot tell yet
  const bool is_calm = !displaced && frame.utime - since >= span / 2;
  if (displaced) {
    ++run_;
    displaced_utime_ = frame.utime;
  } else if (is_calm || displaced_utime_ < oldest) {
    run_ = 0;
  }
  return run_ >= rules_.displacement_frames;
}

// Who is lifted while driving may have been moved by slipping wheels before, but not since they stand. Any look since
// then tells: the first may be one that hardly says where the thing was.
bool OdometryConsistency::is_displaced(const Look& before, const Look& now) const {
  return is_beyond_slip(before, now, wheel_base_, rules_.displacement) ||
         std::any_of(looks_.begin(), looks_.end(), [&](const Look& look) {
           return look.object == now.object && look.utime >= at_rest_since_ &&
                  is_beyond_slip(look, now, wheel_base_, rules_.displacement);
         });
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
