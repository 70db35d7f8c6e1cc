#include "services/localizer/integrity/unexpected_object.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kSamePlace = 0.6;              // [m] the centre of a thing that the border cuts may be found elsewhere
constexpr double kSameHeading = radians(20.0);  // its long side not
constexpr double kForgetAfter = 2.0;            // [m] from where it was last seen, before odometry mixes things up

}  // namespace

std::optional<Eigen::Vector2d> UnexpectedObject::look(const SightingFrame& frame,
                                                      const std::vector<FixtureMatch>& matches,
                                                      const Pose2& odom_from_robot) {
  std::erase_if(things_,
                [&](const Thing& thing) { return distance(thing.odom_from_robot, odom_from_robot) > kForgetAfter; });
  for (Thing& thing : things_) {
    const bool is_false_alarm = ++thing.unseen > kMaxGap && thing.frames < rules_.newcomer_frames;
    thing.frames = is_false_alarm ? 0 : thing.frames;
  }
  std::optional<Eigen::Vector2d> newcomer;
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const FixtureSighting& sighting = frame.sightings[i];
    Thing& thing = find_or_add(sighting, odom_from_robot);
    thing.odom_from_thing = odom_from_robot * sighting.robot_from_fixture;
    thing.odom_from_robot = odom_from_robot;
    thing.is_explained = thing.is_explained || std::any_of(matches.begin(), matches.end(),
                                                           [&](const FixtureMatch& m) { return m.sighting == i; });
    thing.unseen = 0;
    ++thing.frames;
    if (!thing.is_explained && thing.frames == rules_.newcomer_frames && thing.odom_unseen &&
        !has_moved(*thing.odom_unseen, odom_from_robot)) {
      newcomer = sighting.robot_from_fixture.position();
    }
  }
  odom_at_frame_ = odom_from_robot;
  return newcomer;
}

void UnexpectedObject::clear() {
  things_.clear();
  odom_at_frame_.reset();
}

UnexpectedObject::Thing& UnexpectedObject::find_or_add(const FixtureSighting& sighting, const Pose2& odom_from_robot) {
  const Pose2 odom_from_sighting = odom_from_robot * sighting.robot_from_fixture;
  const auto known = std::find_if(things_.begin(), things_.end(), [&](const Thing& thing) {
    const double period = symmetry_period(sighting.shape);
    const bool may_turn = period == 0.0 || !sighting.has_theta || !thing.has_theta || thing.shape != sighting.shape;
    return distance(thing.odom_from_thing, odom_from_sighting) < kSamePlace &&
           (may_turn ||
            std::abs(wrap_modulo(thing.odom_from_thing.theta - odom_from_sighting.theta, period)) < kSameHeading);
  });
  if (known != things_.end()) {
    return *known;
  }
  Thing& thing = things_.emplace_back();
  thing.shape = sighting.shape;
  thing.has_theta = sighting.has_theta;
  thing.odom_unseen = odom_at_frame_;
  return thing;
}

bool UnexpectedObject::has_moved(const Pose2& odom_from_before, const Pose2& odom_from_now) const {
  const Pose2 step = odom_from_before.inverse() * odom_from_now;
  return std::hypot(step.x, step.y) >= rules_.still_distance || std::abs(step.theta) >= rules_.still_turn;
}

}  // namespace luminav
