#include "services/localizer/integrity/missing_fixtures.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kVisibleMargin = 0.03;  // [m] from the image border, beside twice the pose's own error
constexpr double kVanishShare = 0.4;     // of a fixture seen just before that must be in view to miss it
constexpr double kMissShare = 0.8;       // likewise of any other fixture
constexpr double kMore = 0.05;           // by which a share is greater, less than one of its sixteen samples

}  // namespace

void MissingFixtures::restart() {
  images_.clear();
  vanished_.reset();
}

void MissingFixtures::clear() {
  restart();
  seen_lately_.clear();
}

void MissingFixtures::match(const std::vector<FixtureMatch>& matches, const PoseBelief& belief) {
  clear();
  for (const FixtureMatch& match : matches) {
    const Fixture& fixture = model_.fixtures[match.fixture];
    const Pose2 robot_from_fixture = belief.pose.inverse() * fixture.world_from_fixture;
    seen_lately_[match.fixture] = model_.view.visible_share(robot_from_fixture, fixture, 0.0);
  }
}

bool MissingFixtures::look(const SightingFrame& frame, const PoseBelief& belief, const KidnapOpportunity& kidnap) {
  if (!frame.shows_unlit) {
    return false;
  }
  const Pose2 since_match = kidnap.since_match();
  const bool stands_still = kidnap.stands_still();
  const double margin = kVisibleMargin + 2.0 * position_sigma(belief.covariance);
  bool any = false;
  std::vector<int> near;
  model_.fixtures.find_near(belief.pose.position(), model_.reach(), near);
  for (const int index : near) {
    const Fixture& fixture = model_.fixtures[index];
    const Pose2 robot_from_fixture = belief.pose.inverse() * fixture.world_from_fixture;
    const bool is_there = std::any_of(frame.sightings.begin(), frame.sightings.end(), [&](const FixtureSighting& s) {
      return distance(s.robot_from_fixture, robot_from_fixture) < 0.5 * fixture.length + 0.2;
    });
    const auto seen = seen_lately_.find(index);
    const bool was_seen = seen != seen_lately_.end();
    const bool vanished = stands_still && was_seen;
    // what was found when less of it was in view is found now
    const double min = vanished   ? kVanishShare
                       : was_seen ? std::clamp(seen->second + kMore, kVanishShare, kMissShare)
                                  : kMissShare;
    // what was seen from here is out of sight only by what the robot moved since: the pose's error was the same then
    const double moved =
        std::hypot(since_match.x, since_match.y) + std::abs(since_match.theta) * robot_from_fixture.position().norm();
    const double min_inside = vanished ? std::min(margin, moved) : margin;
    if (is_there || model_.fixtures.is_doubted(index) ||
        model_.view.visible_share(robot_from_fixture, fixture, min_inside) < min) {
      continue;
    }
    any = true;
    if (++images_[index] >= rules_.vanish_frames && vanished) {
      vanished_ = index;
    }
  }
  return any;
}

std::optional<int> MissingFixtures::find(double distance_since_match, bool was_kidnapped) const {
  if (vanished_) {
    return vanished_;
  }
  // The detector misses a fixture from some places while the robot passes; that it misses several, or one over a long
  // way, is unlikely. Who stood still since the last match may have been carried: then few images are enough.
  int worst = -1;
  int several = 0;
  for (const auto& [index, images] : images_) {
    several += images >= rules_.miss_frames ? 1 : 0;
    if (worst < 0 || images > images_.at(worst)) {
      worst = index;
    }
  }
  const bool over_a_distance =
      worst >= 0 && images_.at(worst) >= rules_.miss_frames && distance_since_match > rules_.miss_distance;
  const bool is_missed = worst >= 0 && (several >= rules_.miss_fixtures || over_a_distance || was_kidnapped);
  return is_missed ? std::optional(worst) : std::nullopt;
}

}  // namespace luminav
