#include "services/localizer/integrity/pose_monitor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr int kStrangeImages = 10;       // of an object, beside fixtures that support the pose of a driving robot
constexpr std::size_t kMaxObjects = 64;  // followed so at a time
constexpr double kVisibleMargin = 0.03;  // [m] from the image border, beside twice the pose's own error
constexpr double kVanishShare = 0.4;     // of a fixture seen just before that must be in view to miss it
constexpr double kMissShare = 0.8;       // likewise of any other fixture
constexpr double kMore = 0.05;           // by which a share is greater, less than one of its sixteen samples

}  // namespace

std::optional<Contradiction> PoseMonitor::look(const SightingFrame& frame, const ObjectTracks& tracks,
                                               const std::vector<FixtureMatch>& matches, const PoseBelief& belief,
                                               const Pose2& odom_from_robot) {
  kidnap_.look(odom_from_robot);
  if (!matches.empty()) {
    note_strangers(frame, tracks, matches, belief);
    match(matches, belief);
    return std::nullopt;
  }
  const std::optional<Eigen::Vector2d> misfit = find_misfit(frame, tracks, belief);
  misfit_ = std::max(0.0, misfit_ + (misfit ? log_evidence::kMisfit : log_evidence::kCalm));
  if (misfit && misfit_ >= rules_.doubt) {
    return Contradiction{.reason = fmt::format("a fixture is seen at ({:.1f}, {:.1f}) where the building has none",
                                               misfit->x(), misfit->y()),
                         .log_prior = log_prior::kAfterMisfit,
                         .may_predict = true,
                         .misfit = misfit};
  }
  add_missing(frame, belief);
  double sum = 0.0;
  int worst = -1;
  for (const auto& [fixture, evidence] : missing_) {
    sum += evidence;
    worst = worst < 0 || evidence > missing_.at(worst) ? fixture : worst;
  }
  if (sum < rules_.doubt) {
    return std::nullopt;
  }
  return Contradiction{
      .reason = fmt::format("fixture {} ought to be in view and is not seen", model_.fixtures[worst].id),
      .log_prior = log_prior::kAfterMiss,
      .missed_fixture = worst};
}

void PoseMonitor::restart() {
  misfit_ = 0.0;
  missing_.clear();
}

void PoseMonitor::begin_anew() {
  restart();
  seen_.clear();
  strange_images_.clear();
}

void PoseMonitor::match(const std::vector<FixtureMatch>& matches, const PoseBelief& belief) {
  restart();
  kidnap_.match();
  seen_.clear();
  for (const FixtureMatch& match : matches) {
    const Fixture& fixture = model_.fixtures[match.fixture];
    seen_[match.fixture] = model_.view.visible_share(belief.pose.inverse() * fixture.world_from_fixture, fixture, 0.0);
  }
}

void PoseMonitor::note_strangers(const SightingFrame& frame, const ObjectTracks& tracks,
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
      model_.fixtures.add_stranger(belief.pose * frame.sightings[i].robot_from_fixture.position());
    }
  }
}

bool PoseMonitor::is_missing(int index, const Pose2& robot_from_fixture, const PoseBelief& belief) const {
  // what was found when less of it was in view is found now
  const auto seen = seen_.find(index);
  double share = seen == seen_.end() ? kMissShare : std::clamp(seen->second + kMore, kVanishShare, kMissShare);
  double margin = kVisibleMargin + 2.0 * position_sigma(belief.covariance);
  if (seen != seen_.end() && kidnap_.stands_still()) {
    // what was seen from here is out of sight only by what the robot moved since: the pose's error was the same then
    const Pose2 since = kidnap_.since_match();
    share = kVanishShare;
    margin =
        std::min(margin, std::hypot(since.x, since.y) + std::abs(since.theta) * robot_from_fixture.position().norm());
  }
  return !model_.fixtures.is_doubted(index) &&
         model_.view.visible_share(robot_from_fixture, model_.fixtures[index], margin) >= share;
}

void PoseMonitor::add_missing(const SightingFrame& frame, const PoseBelief& belief) {
  if (!frame.shows_unlit) {
    return;
  }
  for (const int index : model_.fixtures.near(belief.pose.position(), model_.reach())) {
    const Fixture& fixture = model_.fixtures[index];
    const Pose2 robot_from_fixture = belief.pose.inverse() * fixture.world_from_fixture;
    const bool is_there = std::any_of(frame.sightings.begin(), frame.sightings.end(), [&](const FixtureSighting& s) {
      return distance(s.robot_from_fixture, robot_from_fixture) < 0.5 * fixture.length + 0.2;
    });
    if (is_there || !is_missing(index, robot_from_fixture, belief)) {
      continue;
    }
    double& evidence = missing_[index];
    if (kidnap_.was_given()) {
      evidence += log_evidence::kCarried;
    } else if (kidnap_.stands_still() && seen_.contains(index)) {
      evidence += log_evidence::kVanished;
    } else {
      evidence = std::max(evidence, std::min(evidence + log_evidence::kMissed, log_evidence::kMaxMissed));
    }
  }
}

std::optional<Eigen::Vector2d> PoseMonitor::find_misfit(const SightingFrame& frame, const ObjectTracks& tracks,
                                                        const PoseBelief& belief) const {
  std::optional<Eigen::Vector2d> misfit;
  for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
    const Eigen::Vector2d place = belief.pose * frame.sightings[i].robot_from_fixture.position();
    if (!model_.fixtures.is_stranger(place) && (tracks.seen(i).frames >= 2 || kidnap_.was_given())) {
      misfit = place;
    }
  }
  return misfit;
}

}  // namespace luminav
