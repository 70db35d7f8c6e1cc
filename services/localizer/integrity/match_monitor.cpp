#include "services/localizer/integrity/match_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/localizer/integrity/wheels_at_rest.hpp"

namespace luminav {
namespace {

constexpr double kMore = 0.05;           // by which a share is greater, less than one of its sixteen samples
constexpr int kStrangeImages = 10;       // of an object, beside fixtures that support the pose of a driving robot
constexpr std::size_t kMaxObjects = 64;  // followed so at a time

}  // namespace

MatchMonitor::MatchMonitor(FixtureMap& map, const CeilingView& view, double ceiling_height, const TrackingRules& rules)
    : map_(map), view_(view), ceiling_height_(ceiling_height), rules_(rules), newcomers_(rules) {}

std::optional<Contradiction> MatchMonitor::look(const SightingFrame& frame, const std::vector<int>& objects,
                                                const ObjectTracks& tracks, const std::vector<FixtureMatch>& matches,
                                                const PoseBelief& belief, const Pose2& odom_from_robot,
                                                double distance_since_match, bool is_suspected) {
  note_pause(odom_from_robot);
  const std::optional<Eigen::Vector2d> newcomer = newcomers_.look(frame, matches, odom_from_robot);
  if (!matches.empty()) {
    note_strangers(frame, objects, tracks, matches, belief);
    note_match(matches, belief, odom_from_robot);
    match_utime_ = frame.utime;
    if (newcomer && !is_suspected && !map_.is_stranger(belief.pose * *newcomer)) {
      misfit_ = belief.pose * *newcomer;
      return Contradiction{fmt::format("something came into view at ({:.1f}, {:.1f}) though the robot stands still",
                                       misfit_->x(), misfit_->y()),
                           rules_.log_prior_after_misfit};
    }
    return std::nullopt;
  }
  const std::optional<Eigen::Vector2d> unexplained = find_unexplained(frame, objects, tracks, belief);
  const bool lacks_something = count_missing(frame, belief, odom_from_robot);
  misfit_run_ += unexplained ? 1 : 0;
  contradicting_ += unexplained || lacks_something ? 1 : 0;
  if (is_suspected) {
    return std::nullopt;
  }
  if (unexplained && (misfit_run_ >= rules_.misfit_frames || was_kidnapped())) {
    misfit_ = unexplained;
    return Contradiction{
        fmt::format("a fixture is seen at ({:.1f}, {:.1f}) where the building has none", unexplained->x(),
                    unexplained->y()),
        is_beyond_kidnapping(frame.utime) ? rules_.log_prior_when_driving : rules_.log_prior_after_misfit, true};
  }
  if (const std::optional<int> missed = missing_too_long(distance_since_match)) {
    missed_fixture_ = *missed;
    return Contradiction{fmt::format("fixture {} ought to be in view and is not seen", map_[*missed].id),
                         rules_.log_prior_after_miss};
  }
  return std::nullopt;
}

void MatchMonitor::reset() {
  strange_images_.clear();
  forget_run();
  seen_lately_.clear();
  newcomers_.clear();
}

void MatchMonitor::confirm(bool was_suspected) {
  if (!was_suspected) {
    predicted_.clear();
  }
  if (was_suspected && missed_fixture_ >= 0) {
    map_.doubt(missed_fixture_);
  }
  if (was_suspected && misfit_) {
    map_.add_stranger(*misfit_);
  }
  missed_fixture_ = -1;
  misfit_.reset();
  forget_run();
}

void MatchMonitor::forget_run() {
  misfit_run_ = 0;
  contradicting_ = 0;
  missed_frames_.clear();
  vanished_.reset();
}

void MatchMonitor::note_pause(const Pose2& odom_from_robot) {
  still_frames_ = are_wheels_at_rest(odom_at_frame_, odom_from_robot) ? still_frames_ + 1 : 0;
  odom_at_frame_ = odom_from_robot;
  if (still_frames_ == 1 && !paused_) {
    contradicting_ = 0;  // a kidnap can begin here
  }
  paused_ = paused_ || still_frames_ >= rules_.pause_frames;
  halted_ = halted_ || still_frames_ >= rules_.halt_frames;
}

bool MatchMonitor::is_beyond_kidnapping(std::int64_t utime) const {
  return !may_be_kidnapped_ && !halted_ && static_cast<int>(predicted_.size()) >= rules_.trusted_fixtures &&
         1e-6 * static_cast<double>(utime - match_utime_) < rules_.match_age;
}

void MatchMonitor::note_match(const std::vector<FixtureMatch>& matches, const PoseBelief& belief,
                              const Pose2& odom_from_robot) {
  forget_run();
  still_frames_ = 0;
  paused_ = false;
  halted_ = false;
  odom_at_match_ = odom_from_robot;
  seen_lately_.clear();
  for (const FixtureMatch& match : matches) {
    const Pose2 robot_from_fixture = belief.pose.inverse() * map_[match.fixture].world_from_fixture;
    seen_lately_[match.fixture] = view_.visible_share(robot_from_fixture, map_[match.fixture], 0.0);
    predicted_.insert(match.fixture);
  }
}

void MatchMonitor::note_strangers(const SightingFrame& frame, const std::vector<int>& objects,
                                  const ObjectTracks& tracks, const std::vector<FixtureMatch>& matches,
                                  const PoseBelief& belief) {
  if (still_frames_ > 0) {
    return;
  }
  if (strange_images_.size() > kMaxObjects) {
    strange_images_.clear();
  }
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const bool is_matched =
        std::any_of(matches.begin(), matches.end(), [&](const FixtureMatch& match) { return match.sighting == i; });
    int& images = strange_images_[tracks.objects()[static_cast<std::size_t>(objects[i])].id];
    images = is_matched ? -kStrangeImages : images + 1;  // a fixture that is hard to see is no stranger
    if (images == kStrangeImages) {
      map_.add_stranger(belief.pose * frame.sightings[i].robot_from_fixture.position());
    }
  }
}

std::optional<Eigen::Vector2d> MatchMonitor::find_unexplained(const SightingFrame& frame,
                                                              const std::vector<int>& objects,
                                                              const ObjectTracks& tracks,
                                                              const PoseBelief& belief) const {
  std::optional<Eigen::Vector2d> unexplained;
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const Eigen::Vector2d place = belief.pose * frame.sightings[i].robot_from_fixture.position();
    if (!map_.is_stranger(place) && tracks.objects()[static_cast<std::size_t>(objects[i])].frames >= 2) {
      unexplained = place;
    }
  }
  return unexplained;
}

bool MatchMonitor::count_missing(const SightingFrame& frame, const PoseBelief& belief, const Pose2& odom_from_robot) {
  const Pose2 since_match = odom_at_match_.inverse() * odom_from_robot;
  const auto moved_less = [&](double distance, double turn) {
    return std::hypot(since_match.x, since_match.y) < distance && std::abs(since_match.theta) < turn;
  };
  // a robot that is lifted while driving rolls on a little after the last image
  const bool stands_still =
      moved_less(rules_.still_distance, rules_.still_turn) ||
      (still_frames_ >= rules_.vanish_frames && moved_less(rules_.stop_distance, rules_.stop_turn));
  const double margin = rules_.visible_margin + 2.0 * position_sigma(belief.covariance);
  bool any = false;
  std::vector<int> near;
  map_.find_near(belief.pose.position(), view_.radius(ceiling_height_) + 1.0, near);
  for (const int index : near) {
    const Pose2 robot_from_fixture = belief.pose.inverse() * map_[index].world_from_fixture;
    const bool is_there = std::any_of(frame.sightings.begin(), frame.sightings.end(), [&](const FixtureSighting& s) {
      return distance(s.robot_from_fixture, robot_from_fixture) < 0.5 * map_[index].length + 0.2;
    });
    const auto seen = seen_lately_.find(index);
    const bool was_seen = seen != seen_lately_.end();
    const bool vanished = stands_still && was_seen;
    // what was found when less of it was in view is found now
    const double min = vanished   ? rules_.vanish_share
                       : was_seen ? std::clamp(seen->second + kMore, rules_.vanish_share, rules_.miss_share)
                                  : rules_.miss_share;
    // what was seen from here is out of sight only by what the robot moved since: the pose's error was the same then
    const double moved =
        std::hypot(since_match.x, since_match.y) + std::abs(since_match.theta) * robot_from_fixture.position().norm();
    const double min_inside = vanished ? std::min(margin, moved) : margin;
    if (is_there || map_.is_doubted(index) || view_.visible_share(robot_from_fixture, map_[index], min_inside) < min) {
      continue;
    }
    any = true;
    const int frames = ++missed_frames_[index];
    if (vanished && frames >= rules_.vanish_frames) {
      vanished_ = index;
    }
  }
  return any;
}

bool MatchMonitor::was_kidnapped() const {
  return (paused_ || may_be_kidnapped_) && contradicting_ >= rules_.misfit_frames;
}

std::optional<int> MatchMonitor::missing_too_long(double distance_since_match) const {
  if (vanished_) {
    return vanished_;
  }
  // The detector misses a fixture from some places while the robot passes; that it misses several, or one over a long
  // way, is unlikely. Who stood still since the last match may have been carried: then few images are enough.
  int worst = -1;
  int several = 0;
  for (const auto& [index, frames] : missed_frames_) {
    several += frames >= rules_.miss_frames ? 1 : 0;
    if (worst < 0 || frames > missed_frames_.at(worst)) {
      worst = index;
    }
  }
  const bool over_a_distance =
      worst >= 0 && missed_frames_.at(worst) >= rules_.miss_frames && distance_since_match > rules_.miss_distance;
  const bool is_missed = worst >= 0 && (several >= rules_.miss_fixtures || over_a_distance || was_kidnapped());
  return is_missed ? std::optional(worst) : std::nullopt;
}

}  // namespace luminav
