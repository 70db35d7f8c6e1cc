#include "services/localizer/integrity/tracking_supervisor.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace luminav {
namespace {

constexpr double kRefuted = 6.0;                // log-score behind the best at which a leader is one no more
constexpr double kSamePlace = 0.5;              // [m] a guess that near
constexpr double kSameHeading = radians(20.0);  // and so little turned means the tracked pose
constexpr double kDeviations = 3.0;             // by which a doubted fixture must be off to be named
constexpr int kRestartFrames = 12;              // images with sightings that no hypothesis explains: begin anew
constexpr const char* kNoFixtures = "the building's file names no fixtures";

}  // namespace

TrackingSupervisor::TrackingSupervisor(FixtureMap& map, ObjectTracks& tracks, HypothesisBank& bank,
                                       TrackingFilter& filter, PoseMonitor& monitor, const TrackingRules& rules)
    : map_(map), tracks_(tracks), bank_(bank), filter_(filter), monitor_(monitor), rules_(rules) {
  if (map_.size() == 0) {
    reason_ = kNoFixtures;
  }
}

bool TrackingSupervisor::decide(const SightingFrame& frame, double distance_since_fixture) {
  drop_refuted_leader();
  if (is_unexplained(frame)) {
    const bool has_pose = !bank_.hypotheses().empty();
    const PoseBelief old = has_leader() ? filter_.belief() : has_pose ? bank_.belief_now(0) : PoseBelief{};
    search_anew("nothing explained what was seen; searching anew");
    if (has_pose) {
      bank_.add_guess(old, 0.0);
    }
  } else if (bank_.hypotheses().empty()) {
    enter(Phase::kSearching, LocalizerState::kLost,
          map_.size() == 0            ? kNoFixtures
          : tracks_.objects().empty() ? "no fixture seen yet"
                                      : "what is seen fits nowhere in the building");
  } else if (is_tracking()) {
    judge_tracked_pose(distance_since_fixture);
  } else if (may_declare(bank_.hypotheses().front(), frame)) {
    return declare_tracking(bank_.hypotheses().front());
  } else {
    enter(phase_, LocalizerState::kAmbiguous, explain_ambiguity());
  }
  return false;
}

void TrackingSupervisor::enter(Phase phase, LocalizerState state, std::string reason) {
  phase_ = phase;
  state_ = state;
  reason_ = std::move(reason);
}

void TrackingSupervisor::search_anew(const std::string& why) {
  leader_id_ = unexplained_run_ = 0;
  tracks_.clear();
  bank_.clear();
  enter(Phase::kSearching, LocalizerState::kLost, why);
}

void TrackingSupervisor::drop_refuted_leader() {
  const Hypothesis* held = leader();
  if (has_leader() && (held == nullptr || bank_.hypotheses().front().log_posterior - held->log_posterior > kRefuted)) {
    leader_id_ = 0;
    enter(Phase::kSearching, LocalizerState::kAmbiguous, reason_);
  }
}

bool TrackingSupervisor::is_unexplained(const SightingFrame& frame) {
  if (frame.sightings.empty() || is_tracking()) {
    return false;
  }
  const std::vector<Hypothesis>& all = bank_.hypotheses();
  // a pose in doubt is not given up for a thing that is no fixture as long as others explain that
  const auto asked = has_leader() ? all.end() : all.begin() + std::min<std::ptrdiff_t>(1, std::ssize(all));
  const bool is_explained =
      std::any_of(all.begin(), asked, [&](const Hypothesis& h) { return h.last_explained == frame.utime; });
  unexplained_run_ = is_explained ? 0 : unexplained_run_ + 1;
  return unexplained_run_ >= kRestartFrames;
}

void TrackingSupervisor::judge_tracked_pose(double distance_since_fixture) {
  const std::vector<Hypothesis>& all = bank_.hypotheses();
  const PoseBelief belief = filter_.belief();
  const double sigma = round_position_sigma(belief.covariance);
  const double heading_sigma = std::sqrt(belief.covariance(2, 2));
  if (all.front().id != leader_id_ ||
      (all.size() > 1 && all[0].log_posterior - all[1].log_posterior < rules_.leave_margin)) {
    enter(Phase::kSearching, LocalizerState::kAmbiguous,
          fmt::format("another of {} poses explains what is seen as well", all.size()));
  } else if (sigma > rules_.leave_position_sigma || heading_sigma > rules_.leave_heading_sigma) {
    enter(Phase::kBlind, LocalizerState::kAmbiguous,
          fmt::format("the pose is only known to {:.2f} m and {:.0f} degrees, {:.1f} m after the last fixture", sigma,
                      degrees(heading_sigma), distance_since_fixture));
  } else {
    reason_ = fmt::format("one pose explains all that was seen; known to {:.0f} mm and {:.1f} degrees{}", 1e3 * sigma,
                          degrees(heading_sigma), describe_doubts());
  }
}

std::string TrackingSupervisor::describe_doubts() const {
  if (map_.doubts() == 0) {
    return "";
  }
  std::string text = fmt::format("; the building's file is doubted at {} places", map_.doubts());
  for (const int fixture : map_.doubted()) {
    const FixtureOffset offset = filter_.offset_of(fixture);
    if (offset.mean.head<2>().norm() > kDeviations * largest_position_sigma(offset.covariance)) {
      text += fmt::format(", fixture {} hangs {:.2f} m off it", map_[fixture].id, offset.mean.head<2>().norm());
    }
  }
  return text;
}

bool TrackingSupervisor::may_declare(const Hypothesis& best, const SightingFrame& frame) const {
  const bool is_leader = best.id == leader_id_;
  const bool was_blind = is_leader && phase_ == Phase::kBlind;
  // who says where the robot is has seen as much as one fixture shows
  const int needed_fixtures = was_blind                               ? 0
                              : is_leader && best.id == suspected_id_ ? suspicion_.needed_fixtures
                              : is_leader                             ? 1
                                          : rules_.enter_fixtures - (best.log_prior > 0.0 ? 1 : 0);
  const Eigen::Matrix3d& covariance = was_blind ? filter_.belief().covariance : best.belief.covariance;
  return margin() >= needed_margin() && is_ahead_without_sonar() &&
         static_cast<int>(best.confirmed.size()) >= needed_fixtures && !frame.sightings.empty() &&
         best.last_match == frame.utime && largest_position_sigma(covariance) < rules_.enter_position_sigma &&
         std::sqrt(covariance(2, 2)) < rules_.enter_heading_sigma;
}

bool TrackingSupervisor::declare_tracking(const Hypothesis& best) {
  if (best.id == std::exchange(suspected_id_, 0)) {
    doubt_map(suspicion_);
  }
  was_tracking_ = true;
  enter(Phase::kFollowing, LocalizerState::kTracking,
        fmt::format("one pose explains {} fixtures, all others fail", best.confirmed.size()));
  if (best.id == leader_id_) {
    monitor_.restart();
    return false;
  }
  PoseBelief start = bank_.belief_now(0);
  start.covariance += Eigen::Vector3d(0.01, 0.01, 0.003).asDiagonal();
  filter_.start(start);
  leader_id_ = best.id;
  monitor_.begin_anew();
  return true;
}

void TrackingSupervisor::doubt_map(const Contradiction& contradiction) {
  if (contradiction.missed_fixture >= 0) {
    map_.doubt(contradiction.missed_fixture);
  }
  if (contradiction.misfit) {
    map_.add_stranger(*contradiction.misfit);
    for (const int fixture : map_.near(*contradiction.misfit, FixtureMap::kMaxOffset)) {
      map_.doubt(fixture);
    }
  }
}

std::string TrackingSupervisor::explain_ambiguity() const {
  if (phase_ != Phase::kSearching) {
    return reason_;
  }
  const std::vector<Hypothesis>& all = bank_.hypotheses();
  const auto close = std::count_if(all.begin(), all.end(), [&](const Hypothesis& h) {
    return h.log_posterior > all.front().log_posterior - needed_margin();
  });
  return close > 1 ? fmt::format("{} poses explain what was seen", close)
         : margin() >= needed_margin() && !is_ahead_without_sonar()
             ? "what the sonars hear speaks against what the ceiling shows"
             : fmt::format("one pose is left, confirmed by {} fixtures so far", all.front().confirmed.size());
}

void TrackingSupervisor::suspect(const Contradiction& contradiction) {
  was_tracking_ = true;  // so too a pose from before a restart
  suspicion_ = contradiction;
  monitor_.restart();
  search_anew(contradiction.reason);
  bank_.add_guess(filter_.belief(), contradiction.log_prior);
  leader_id_ = suspected_id_ = bank_.hypotheses().front().id;
  enter(Phase::kDoubted, LocalizerState::kAmbiguous, contradiction.reason);
}

void TrackingSupervisor::suspend(const std::string& why) {
  enter(Phase::kDisplaced, has_leader() ? LocalizerState::kAmbiguous : LocalizerState::kLost, why);
}

void TrackingSupervisor::resume(bool was_followed) {
  if (was_followed) {
    suspect({.reason = reason_, .log_prior = log_prior::kAfterMisfit, .may_predict = true});
    return;
  }
  was_tracking_ = false;  // it is plain that it was carried: no pose is in doubt, and the search is as the first one
  monitor_.begin_anew();
  search_anew("nothing seen since the robot was moved elsewhere");
}

void TrackingSupervisor::favour_predicting_pose() {
  Hypothesis* held = leader();
  if (held != nullptr && !held->confirmed.empty() && std::exchange(suspicion_.may_predict, false)) {
    // A robot put elsewhere sees a fixture where the old pose has one in perhaps one of a hundred cases.
    held->log_prior += log_prior::kWhenPredicted;
  }
}

// The filter follows a robot that somebody pushes or carries slowly, for fixtures stand metres apart. The leader, which
// believes the wheels more, would lose sight of them all, and seconds later its place to any other pose.
void TrackingSupervisor::keep_leader_at_filter(const SightingFrame& frame) {
  const Hypothesis* held = is_tracking() || phase_ == Phase::kBlind ? leader() : nullptr;
  if (held != nullptr && !bank_.is_busy() && held->last_match < frame.utime) {
    bank_.place(static_cast<std::size_t>(held - bank_.hypotheses().data()), filter_.belief());
  }
}

void TrackingSupervisor::add_rival(const PoseBelief& belief) {
  const Hypothesis* held = leader();
  if (held == nullptr || is_near(filter_.belief().pose, belief.pose, kSamePlace, kSameHeading)) {
    return;  // that is where it is held to be
  }
  const double log_posterior = held->log_posterior;
  bank_.add_guess(belief, 0.0);
  Hypothesis& rival = bank_.hypotheses().back();
  rival.log_prior = log_posterior - rival.closed_score;
}

Hypothesis* TrackingSupervisor::leader() const {
  const auto found = std::find_if(bank_.hypotheses().begin(), bank_.hypotheses().end(),
                                  [&](const Hypothesis& h) { return h.id == leader_id_; });
  return found == bank_.hypotheses().end() ? nullptr : &*found;
}

double TrackingSupervisor::margin() const {
  const std::vector<Hypothesis>& all = bank_.hypotheses();
  return all.front().log_posterior - std::max(all.size() > 1 ? all[1].log_posterior : -1e18, bank_.null_score());
}

double TrackingSupervisor::needed_margin() const {
  const bool is_blind_leader = phase_ == Phase::kBlind && bank_.hypotheses().front().id == leader_id_;
  return is_blind_leader ? rules_.leave_margin : was_tracking_ ? rules_.enter_margin : rules_.first_margin;
}

bool TrackingSupervisor::is_ahead_without_sonar() const {
  // Boxes that no map knows sound like walls, and may make one of two rooms with the same ceiling sound like the other.
  const std::vector<Hypothesis>& all = bank_.hypotheses();
  const double min = all.front().without_sonar() - rules_.min_without_sonar;
  return std::all_of(all.begin() + 1, all.end(), [&](const Hypothesis& rival) { return rival.without_sonar() <= min; });
}

}  // namespace luminav
