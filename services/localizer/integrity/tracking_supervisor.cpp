#include "services/localizer/integrity/tracking_supervisor.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kRefuted = 6.0;                // log-score behind the best at which a leader is one no more
constexpr double kSamePlace = 0.5;              // [m] a guess that near
constexpr double kSameHeading = radians(20.0);  // and so little turned means the tracked pose
constexpr double kDeviations = 3.0;             // by which a doubted fixture must be off to be named
constexpr int kRestartFrames = 12;              // images with sightings that no hypothesis explains: begin anew
constexpr const char* kNoFixtures = "the building's file names no fixtures";

}  // namespace

TrackingSupervisor::TrackingSupervisor(const FixtureMap& map, ObjectTracks& tracks, HypothesisBank& bank,
                                       TrackingFilter& filter, MatchMonitor& monitor, const TrackingRules& rules)
    : map_(map), tracks_(tracks), bank_(bank), filter_(filter), monitor_(monitor), rules_(rules) {
  if (map_.size() == 0) {
    reason_ = kNoFixtures;
  }
}

bool TrackingSupervisor::decide(const SightingFrame& frame, double distance_since_fixture) {
  if (bank_.hypotheses().empty()) {
    drop_leader(LocalizerState::kLost);
    unexplained_run_ += frame.sightings.empty() ? 0 : 1;
    if (unexplained_run_ >= kRestartFrames) {
      unexplained_run_ = 0;
      tracks_.clear();  // some of it was false, or the map is wrong there: what is seen next may fit
      bank_.clear();
    }
    reason_ = map_.size() == 0            ? kNoFixtures
              : tracks_.objects().empty() ? "no fixture seen yet"
                                          : "what is seen fits nowhere in the building";
    return false;
  }
  drop_refuted_leader();
  if (begin_anew_if_unexplained(frame)) {
    return false;
  }
  if (is_tracking()) {
    judge_tracked_pose(distance_since_fixture);
    return false;
  }
  if (resume_tracking(frame)) {
    return false;
  }
  const Hypothesis best = bank_.hypotheses().front();
  if (may_declare(best, frame)) {
    return declare_tracking(best);
  }
  explain_ambiguity();
  return false;
}

void TrackingSupervisor::drop_leader(LocalizerState state) {
  leader_id_ = 0;
  wide_ = false;
  suspicion_.clear();
  may_predict_ = false;
  state_ = state;
}

void TrackingSupervisor::drop_refuted_leader() {
  if (leader_id_ == 0) {
    return;
  }
  const Hypothesis* held = leader();
  if (held == nullptr || bank_.hypotheses().front().log_posterior - held->log_posterior > kRefuted) {
    drop_leader(LocalizerState::kAmbiguous);
  }
}

bool TrackingSupervisor::begin_anew_if_unexplained(const SightingFrame& frame) {
  if (frame.sightings.empty() || is_tracking()) {
    return false;
  }
  const Hypothesis& best = bank_.hypotheses().front();
  // a pose in doubt is not given up for a thing that is no fixture as long as others explain that
  const auto explains = [&](const Hypothesis& h) { return h.last_match == frame.utime; };
  const bool is_explained =
      leader_id_ == 0 ? explains(best) : std::any_of(bank_.hypotheses().begin(), bank_.hypotheses().end(), explains);
  unexplained_run_ = is_explained ? 0 : unexplained_run_ + 1;
  if (unexplained_run_ < kRestartFrames) {
    return false;
  }
  unexplained_run_ = 0;
  const PoseBelief old = leader_id_ != 0 ? filter_.belief() : bank_.belief_now(0);
  tracks_.clear();
  bank_.clear();
  bank_.add_guess(old, 0.0);
  drop_leader(LocalizerState::kLost);
  reason_ = "nothing explained what was seen; searching anew";
  return true;
}

void TrackingSupervisor::judge_tracked_pose(double distance_since_fixture) {
  const std::vector<Hypothesis>& all = bank_.hypotheses();
  const Hypothesis& best = all.front();
  const PoseBelief belief = leader_id_ != 0 ? filter_.belief() : best.belief;
  const double sigma = largest_position_sigma(belief.covariance);
  const double heading_sigma = std::sqrt(belief.covariance(2, 2));
  const double second = all.size() > 1 ? all[1].log_posterior : -1e18;
  const double ahead = (leader() != nullptr ? leader()->log_posterior : -1e18) -
                       (all.size() > 1 ? (best.id == leader_id_ ? second : best.log_posterior) : -1e18);
  if (ahead < rules_.leave_margin) {
    state_ = LocalizerState::kAmbiguous;
    reason_ = fmt::format("another of {} poses explains what is seen as well", all.size());
  } else if (sigma > rules_.leave_position_sigma || heading_sigma > rules_.leave_heading_sigma) {
    state_ = LocalizerState::kAmbiguous;
    wide_ = true;
    reason_ = fmt::format("no fixture for {:.1f} m: the pose is only known to {:.2f} m", distance_since_fixture, sigma);
  } else {
    reason_ = fmt::format("one pose explains all that was seen; known to {:.0f} mm and {:.1f} degrees", 1e3 * sigma,
                          degrees(heading_sigma));
    reason_ += describe_doubts();
  }
}

std::string TrackingSupervisor::describe_doubts() const {
  if (map_.doubts() == 0) {
    return "";
  }
  std::string text = fmt::format("; the building's file is doubted at {} places", map_.doubts());
  for (const int fixture : map_.doubted()) {
    const FixtureOffset offset = filter_.offset_of(fixture);
    const double sigma = largest_position_sigma(offset.covariance);
    if (offset.mean.head<2>().norm() > kDeviations * sigma) {
      text += fmt::format(", fixture {} hangs {:.2f} m off it", map_[fixture].id, offset.mean.head<2>().norm());
    }
  }
  return text;
}

bool TrackingSupervisor::resume_tracking(const SightingFrame& frame) {
  const Hypothesis& best = bank_.hypotheses().front();
  if (!wide_ || leader_id_ == 0 || best.id != leader_id_ || best.last_match != frame.utime || !suspicion_.empty() ||
      margin() < rules_.leave_margin ||
      largest_position_sigma(filter_.belief().covariance) >= rules_.enter_position_sigma) {
    return false;
  }
  wide_ = false;
  state_ = LocalizerState::kTracking;
  return true;
}

bool TrackingSupervisor::may_declare(const Hypothesis& best, const SightingFrame& frame) const {
  // who says where the robot is has seen as much as one fixture shows
  const int told = best.log_prior > 0.0 ? 1 : 0;
  const int enough_fixtures = best.id == leader_id_ ? needed_fixtures_ : rules_.enter_fixtures - told;
  return is_far_ahead() && static_cast<int>(best.confirmed.size()) >= enough_fixtures && !frame.sightings.empty() &&
         best.last_match == frame.utime && largest_position_sigma(best.belief.covariance) < rules_.enter_position_sigma;
}

bool TrackingSupervisor::declare_tracking(const Hypothesis& best) {
  const bool is_new = best.id != leader_id_;
  if (is_new) {
    PoseBelief start = bank_.belief_now(0);
    start.covariance += Eigen::Vector3d(0.01, 0.01, 0.003).asDiagonal();
    filter_.start(start);
    leader_id_ = best.id;
  }
  monitor_.confirm(best.id == suspected_id_);
  was_tracking_ = true;
  wide_ = false;
  suspicion_.clear();
  may_predict_ = false;
  state_ = LocalizerState::kTracking;
  reason_ = fmt::format("one pose explains {} fixtures, all others fail", best.confirmed.size());
  return is_new;
}

void TrackingSupervisor::explain_ambiguity() {
  state_ = LocalizerState::kAmbiguous;
  if (!suspicion_.empty()) {
    reason_ = suspicion_;
  } else if (!wide_) {
    const std::vector<Hypothesis>& all = bank_.hypotheses();
    const Hypothesis& best = all.front();
    const auto close = std::count_if(all.begin(), all.end(), [&](const Hypothesis& h) {
      return h.log_posterior > best.log_posterior - needed_margin();
    });
    reason_ = close > 1 ? fmt::format("{} poses explain what was seen", close)
              : margin() >= needed_margin() && !is_far_ahead()
                  ? "what the sonars hear speaks against what the ceiling shows"
                  : fmt::format("one pose is left, confirmed by {} fixtures so far", best.confirmed.size());
  }
}

void TrackingSupervisor::suspect(const Contradiction& contradiction) {
  was_tracking_ = true;  // so too a pose from before a restart
  reason_ = suspicion_ = contradiction.reason;
  wide_ = false;
  may_predict_ = contradiction.is_misfit;
  needed_fixtures_ = contradiction.needed_fixtures;
  monitor_.reset();
  tracks_.clear();
  bank_.clear();
  bank_.add_guess(filter_.belief(), contradiction.log_prior);
  leader_id_ = suspected_id_ = bank_.hypotheses().front().id;
  state_ = LocalizerState::kAmbiguous;
}

void TrackingSupervisor::suspect_slip(const PoseBelief& slipped) {
  suspect({"the sonars hear the walls as if the wheels had slipped", log_prior::kAfterMiss});
  bank_.add_guess(slipped, log_prior::kAfterMiss);
}

void TrackingSupervisor::suspend(const std::string& why) {
  suspicion_ = why;
  state_ = leader_id_ != 0 ? LocalizerState::kAmbiguous : LocalizerState::kLost;
  reason_ = why;
}

void TrackingSupervisor::resume(bool was_followed) {
  if (was_followed) {
    suspect({reason_, log_prior::kAfterMisfit, true});
    return;
  }
  was_tracking_ = false;  // it is plain that it was carried: no pose is in doubt, and the search is as the first one
  monitor_.reset();
  tracks_.clear();
  bank_.clear();
  drop_leader(LocalizerState::kLost);
  reason_ = "nothing seen since the robot was moved elsewhere";
}

void TrackingSupervisor::add_moved(const PoseBelief& belief, double log_prior) {
  bank_.add_guess(belief, log_prior);
  moved_id_ = bank_.hypotheses().back().id;
}

void TrackingSupervisor::favour_predicting_pose() {
  // the first fixture that it fits is the one by which it was found
  if (Hypothesis* moved = find(moved_id_); moved != nullptr && moved->confirmed.size() >= 2) {
    moved->log_prior += log_prior::kWhenPredicted;
    moved_id_ = 0;
  }
  Hypothesis* held = leader();
  if (!may_predict_ || held == nullptr || held->confirmed.empty()) {
    return;
  }
  // A robot put elsewhere sees a fixture where the old pose has one in perhaps one of a hundred cases.
  may_predict_ = false;
  held->log_prior += log_prior::kWhenPredicted;
}

// The filter follows a robot that somebody pushes or carries slowly, for fixtures stand metres apart. The leader, which
// believes the wheels more, would lose sight of them all, and seconds later its place to any other pose.
void TrackingSupervisor::keep_leader_at_filter(const SightingFrame& frame) {
  const Hypothesis* held = leader();
  if (is_tracking() && suspicion_.empty() && held != nullptr && !bank_.is_busy() && held->last_match < frame.utime) {
    bank_.place(static_cast<std::size_t>(held - bank_.hypotheses().data()), filter_.belief());
  }
}

void TrackingSupervisor::add_rival(const PoseBelief& belief) {
  const Hypothesis* held = leader();
  const Pose2 pose = filter_.belief().pose;
  if (held == nullptr || (distance(pose, belief.pose) < kSamePlace &&
                          std::abs(wrap_angle(pose.theta - belief.pose.theta)) < kSameHeading)) {
    return;  // that is where it is held to be
  }
  // as good as the tracked pose for now: what is seen next decides, and until then two poses are possible
  const double log_posterior = held->log_posterior;
  bank_.add_guess(belief, 0.0);
  Hypothesis& rival = bank_.hypotheses().back();
  rival.log_prior = log_posterior - rival.closed_score;
}

Hypothesis* TrackingSupervisor::find(int id) const {
  const auto found = std::find_if(bank_.hypotheses().begin(), bank_.hypotheses().end(),
                                  [&](const Hypothesis& h) { return h.id == id; });
  return found == bank_.hypotheses().end() ? nullptr : &*found;
}

double TrackingSupervisor::margin() const {
  const std::vector<Hypothesis>& all = bank_.hypotheses();
  const double second = all.size() > 1 ? all[1].log_posterior : -1e18;
  return all.front().log_posterior - std::max(second, bank_.null_score());
}

bool TrackingSupervisor::is_far_ahead() const {
  if (margin() < needed_margin()) {
    return false;
  }
  // Boxes that no map knows sound like walls, and may make one of two rooms with the same ceiling sound like the other.
  const std::vector<Hypothesis>& all = bank_.hypotheses();
  const auto without_sonar = [](const Hypothesis& h) { return h.log_posterior - h.sonar_part; };
  const double min = without_sonar(all.front()) - rules_.min_without_sonar;
  return std::all_of(all.begin() + 1, all.end(), [&](const Hypothesis& rival) { return without_sonar(rival) <= min; });
}

}  // namespace luminav
