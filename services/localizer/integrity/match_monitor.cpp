#include "services/localizer/integrity/match_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace luminav {
namespace {

// The pose of a driving robot is believed against a misfit if its last match is not older and it predicted so many
// different fixtures.
constexpr double kMatchAge = 3.0;  // [s]
constexpr int kTrustedFixtures = 8;
constexpr int kMaxGap = 10;              // images in a row that show nothing strange: strange ones before were false
constexpr int kStrangeImages = 10;       // of an object, beside fixtures that support the pose of a driving robot
constexpr std::size_t kMaxObjects = 64;  // followed so at a time

}  // namespace

MatchMonitor::MatchMonitor(ObservationModel& model, const TrackingRules& rules)
    : map_(model.fixtures), rules_(rules), kidnap_(rules), missing_(model, rules) {}

std::optional<Contradiction> MatchMonitor::look(const SightingFrame& frame, const ObjectTracks& tracks,
                                                const std::vector<FixtureMatch>& matches, const PoseBelief& belief,
                                                const Pose2& odom_from_robot, double distance_since_match,
                                                bool is_suspected) {
  if (kidnap_.look(odom_from_robot)) {
    contradicting_ = 0;  // a kidnap can begin here
  }
  if (!matches.empty()) {
    note_strangers(frame, tracks, matches, belief);
    note_match(matches, belief);
    match_utime_ = frame.utime;
    return std::nullopt;
  }
  const std::optional<Eigen::Vector2d> unexplained = find_unexplained(frame, tracks, belief);
  const bool lacks_something = missing_.look(frame, belief, kidnap_);
  quiet_ = unexplained || lacks_something ? 0 : quiet_ + 1;
  if (quiet_ > kMaxGap) {
    misfit_run_ = contradicting_ = 0;
  }
  misfit_run_ += unexplained ? 1 : 0;
  contradicting_ += unexplained || lacks_something ? 1 : 0;
  if (is_suspected) {
    return std::nullopt;
  }
  if (unexplained && (misfit_run_ >= rules_.misfit_frames || was_kidnapped())) {
    misfit_ = unexplained;
    return Contradiction{fmt::format("a fixture is seen at ({:.1f}, {:.1f}) where the building has none",
                                     unexplained->x(), unexplained->y()),
                         is_beyond_kidnapping(frame.utime) ? log_prior::kWhenDriving : log_prior::kAfterMisfit, true};
  }
  if (const std::optional<int> missed = missing_.find(distance_since_match, was_kidnapped())) {
    missed_fixture_ = *missed;
    return Contradiction{fmt::format("fixture {} ought to be in view and is not seen", map_[*missed].id),
                         log_prior::kAfterMiss};
  }
  return std::nullopt;
}

void MatchMonitor::reset() {
  strange_images_.clear();
  forget_run();
  missing_.clear();
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
    std::vector<int> near;
    map_.find_near(*misfit_, FixtureMap::kMaxOffset, near);
    for (const int fixture : near) {
      map_.doubt(fixture);
    }
  }
  missed_fixture_ = -1;
  misfit_.reset();
  forget_run();
}

void MatchMonitor::forget_run() {
  misfit_run_ = 0;
  contradicting_ = 0;
  missing_.restart();
}

bool MatchMonitor::is_beyond_kidnapping(std::int64_t utime) const {
  return kidnap_.is_excluded() && static_cast<int>(predicted_.size()) >= kTrustedFixtures &&
         1e-6 * static_cast<double>(utime - match_utime_) < kMatchAge;
}

void MatchMonitor::note_match(const std::vector<FixtureMatch>& matches, const PoseBelief& belief) {
  forget_run();
  kidnap_.match();
  missing_.match(matches, belief);
  for (const FixtureMatch& match : matches) {
    predicted_.insert(match.fixture);
  }
}

void MatchMonitor::note_strangers(const SightingFrame& frame, const ObjectTracks& tracks,
                                  const std::vector<FixtureMatch>& matches, const PoseBelief& belief) {
  if (kidnap_.are_wheels_still()) {
    return;
  }
  if (strange_images_.size() > kMaxObjects) {
    strange_images_.clear();
  }
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const bool is_matched =
        std::any_of(matches.begin(), matches.end(), [&](const FixtureMatch& match) { return match.sighting == i; });
    int& images = strange_images_[tracks.seen(i).id];
    images = is_matched ? -kStrangeImages : images + 1;  // a fixture that is hard to see is no stranger
    if (images == kStrangeImages) {
      map_.add_stranger(belief.pose * frame.sightings[i].robot_from_fixture.position());
    }
  }
}

std::optional<Eigen::Vector2d> MatchMonitor::find_unexplained(const SightingFrame& frame, const ObjectTracks& tracks,
                                                              const PoseBelief& belief) const {
  std::optional<Eigen::Vector2d> unexplained;
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const Eigen::Vector2d place = belief.pose * frame.sightings[i].robot_from_fixture.position();
    if (!map_.is_stranger(place) && tracks.seen(i).frames >= 2) {
      unexplained = place;
    }
  }
  return unexplained;
}

bool MatchMonitor::was_kidnapped() const {
  return kidnap_.was_given() && contradicting_ >= rules_.misfit_frames;
}

}  // namespace luminav
