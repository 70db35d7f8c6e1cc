#include "services/caretaker/visit_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace luminav {
namespace {

constexpr std::size_t kMaxWaiting = 30;    // frames that no pose came for
constexpr double kMinSpacingShare = 0.45;  // of the distance to the next fixture: nearer is this one
constexpr double kStrangerReach = 0.35;    // [m] within which two sightings are of one stranger
constexpr double kSecond = 1e6;            // [us]
constexpr std::size_t kMaxKept = 400;      // sightings of a visit, of which the median is taken

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Of each coordinate by itself. Angles are taken beside the first one.
Pose2 median(const std::vector<Pose2>& poses, double period) {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> turn;
  for (const Pose2& pose : poses) {
    x.push_back(pose.x);
    y.push_back(pose.y);
    const double apart = pose.theta - poses.front().theta;
    turn.push_back(period > 0.0 ? std::remainder(apart, period) : 0.0);
  }
  return {median(x), median(y), wrap_angle(poses.front().theta + median(turn))};
}

double larger_side(const Fixture& fixture) {
  return std::max(fixture.length, fixture.width);
}

}  // namespace

VisitRecorder::VisitRecorder(const CameraDescription& camera, std::vector<Fixture> fixtures, VisitParams params)
    : view_(camera), map_(std::move(fixtures)), params_(params) {
  gate_ = std::min(params_.max_offset, kMinSpacingShare * map_.smallest_spacing());
  double height = 0.0;
  double longest = 0.0;
  for (const Fixture& fixture : map_.fixtures()) {
    height = std::max(height, fixture.height);
    longest = std::max(longest, larger_side(fixture));
  }
  radius_ = view_.radius(height) + longest;
}

void VisitRecorder::add_pose(const KnownPose& pose) {
  if (!pose.is_sure) {
    poses_.clear();
    waiting_.clear();
    return;
  }
  if (!poses_.is_empty() && pose.reading.session == poses_.newest().session &&
      pose.reading.utime <= poses_.newest().utime) {
    return;
  }
  poses_.add(pose.reading);
  while (!waiting_.empty() && waiting_.front().frame.utime <= pose.reading.utime) {
    if (const auto robot = poses_.at(waiting_.front().frame.utime)) {
      look(waiting_.front(), *robot);
    }
    waiting_.pop_front();
  }
}

void VisitRecorder::add_frame(const LookedAtFrame& frame) {
  if (poses_.is_empty()) {
    return;
  }
  if (const auto robot = poses_.at(frame.frame.utime)) {
    look(frame, *robot);
  } else if (frame.frame.utime > poses_.newest().utime && waiting_.size() < kMaxWaiting) {
    waiting_.push_back(frame);
  }
}

VisitRecorder::Result VisitRecorder::take_ended() {
  return std::exchange(ended_, {});
}

void VisitRecorder::end_all() {
  for (const auto& [fixture, open] : open_) {
    end(fixture, open);
  }
  open_.clear();
  for (OpenStranger& open : strangers_) {
    end(open);
  }
  strangers_.clear();
}

void VisitRecorder::look(const LookedAtFrame& looked, const OdometryReading& robot) {
  const std::int64_t utime = looked.frame.utime;
  end_visits_before(utime - static_cast<std::int64_t>(params_.absence * kSecond));
  const Pose2& world_from_robot = robot.odom_from_robot;
  const std::vector<int> near = map_.near(world_from_robot.position(), radius_);
  std::vector<FixtureSighting> sightings;
  for (const FixtureSighting& sighting : looked.frame.sightings) {
    const double height = near.empty() ? 0.0 : map_[near.front()].height;
    sightings.push_back(view_.without_rolling_shutter(sighting, height, robot.linear, robot.angular));
  }
  const std::vector<int> matches = match(sightings, world_from_robot, near);
  for (const int fixture : near) {
    const Pose2 robot_from_fixture = world_from_robot.inverse() * map_[fixture].world_from_fixture;
    if (!view_.is_wholly_visible(robot_from_fixture, map_[fixture], params_.margin)) {
      continue;
    }
    const auto found = std::find(matches.begin(), matches.end(), fixture);
    const auto index = static_cast<std::size_t>(found - matches.begin());
    count(fixture, found == matches.end() ? nullptr : &sightings[index], looked, world_from_robot);
  }
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (matches[i] < 0 && !sightings[i].clipped) {
      add_stranger(sightings[i], utime, world_from_robot);
    }
  }
}

std::vector<int> VisitRecorder::match(const std::vector<FixtureSighting>& sightings, const Pose2& world_from_robot,
                                      const std::vector<int>& near) const {
  struct Pair {
    double distance;
    std::size_t sighting;
    int fixture;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const Pose2 seen = world_from_robot * sightings[i].robot_from_fixture;
    for (const int fixture : near) {
      const double apart = distance(seen, map_[fixture].world_from_fixture);
      if (apart < gate_ + (sightings[i].clipped ? 0.5 * larger_side(map_[fixture]) : 0.0) &&
          fits_kind_and_size(sightings[i], map_[fixture], {})) {
        pairs.push_back({apart, i, fixture});
      }
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  std::vector<int> matches(sightings.size(), -1);
  for (const Pair& pair : pairs) {
    if (matches[pair.sighting] < 0 && std::find(matches.begin(), matches.end(), pair.fixture) == matches.end()) {
      matches[pair.sighting] = pair.fixture;
    }
  }
  return matches;
}

void VisitRecorder::count(int fixture, const FixtureSighting* sighting, const LookedAtFrame& looked,
                          const Pose2& world_from_robot) {
  OpenVisit& open = open_[fixture];
  FixtureVisit& visit = open.visit;
  if (visit.expected == 0) {
    visit.begin = looked.frame.utime;
  }
  visit.end = looked.frame.utime;
  ++visit.expected;
  visit.grey += (looked.grey - visit.grey) / visit.expected;
  const SightingState state = sighting == nullptr ? SightingState::kUnknown : sighting->state;
  const bool is_burning = state == SightingState::kLit || state == SightingState::kHalf;
  visit.changes += visit.expected > 1 && is_burning != open.was_burning ? 1 : 0;
  open.was_burning = is_burning;
  visit.lit += state == SightingState::kLit ? 1 : 0;
  visit.half += state == SightingState::kHalf ? 1 : 0;
  visit.unlit += state == SightingState::kUnlit ? 1 : 0;
  if (state == SightingState::kUnknown) {
    return;
  }
  if (!sighting->clipped && open.offsets.size() < kMaxKept) {
    const Pose2 seen = world_from_robot * sighting->robot_from_fixture;
    const Pose2& place = map_[fixture].world_from_fixture;
    const double period = symmetry_period(map_[fixture].shape);
    const double turn = sighting->has_theta && period > 0.0 ? std::remainder(seen.theta - place.theta, period) : 0.0;
    open.offsets.push_back({seen.x - place.x, seen.y - place.y, turn});
  }
}

void VisitRecorder::add_stranger(const FixtureSighting& sighting, std::int64_t utime, const Pose2& world_from_robot) {
  const Pose2 seen = world_from_robot * sighting.robot_from_fixture;
  auto open = std::find_if(strangers_.begin(), strangers_.end(), [&](const OpenStranger& other) {
    return other.visit.shape == sighting.shape && distance(other.poses.back(), seen) < kStrangerReach;
  });
  if (open == strangers_.end()) {
    open = strangers_.insert(open, OpenStranger{});
    open->visit.shape = sighting.shape;
    open->visit.begin = utime;
  }
  open->visit.end = utime;
  ++open->visit.seen;
  if (open->poses.size() >= kMaxKept) {
    return;
  }
  open->poses.push_back(seen);
  open->lengths.push_back(sighting.length);
  open->widths.push_back(sighting.width);
}

void VisitRecorder::end_visits_before(std::int64_t utime) {
  const auto is_over = [&](const auto& visit) {
    return visit.end < utime || visit.end - visit.begin > static_cast<std::int64_t>(params_.max_time * kSecond);
  };
  for (auto open = open_.begin(); open != open_.end();) {
    if (is_over(open->second.visit)) {
      end(open->first, open->second);
      open = open_.erase(open);
    } else {
      ++open;
    }
  }
  for (OpenStranger& open : strangers_) {
    if (is_over(open.visit)) {
      end(open);
    }
  }
  std::erase_if(strangers_, [&](const OpenStranger& open) { return is_over(open.visit); });
}

void VisitRecorder::end(int fixture, const OpenVisit& open) {
  if (open.visit.expected < params_.min_images) {
    return;
  }
  FixtureVisit visit = open.visit;
  if (!open.offsets.empty()) {
    visit.offset = median(open.offsets, symmetry_period(map_[fixture].shape));
  }
  ended_.fixtures.emplace_back(fixture, visit);
}

void VisitRecorder::end(OpenStranger& open) {
  if (open.visit.seen < params_.min_images) {
    return;
  }
  open.visit.world_from_fixture = median(open.poses, symmetry_period(open.visit.shape));
  open.visit.length = median(open.lengths);
  open.visit.width = median(open.widths);
  ended_.strangers.push_back(open.visit);
}

}  // namespace luminav
