#include "services/localizer/hypotheses/hypothesis_bank.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace luminav {
namespace {

constexpr int kLongestRound = 8;       // [steps] of hearing echoes; beyond it some are left out
constexpr std::size_t kFewEchoes = 3;  // that are always heard

double log_of_normal_tail(double deviations) {
  // log of the normal distribution function; below -5 nothing is told apart any more
  constexpr double kCertain = 8.5;  // beyond it the function is 1 to the last bit
  return deviations > kCertain ? 0.0 : std::log(std::max(3e-7, 0.5 * std::erfc(-deviations / std::sqrt(2.0))));
}

}  // namespace

HypothesisBank::HypothesisBank(const ObservationModel& model, const HypothesisParams& params)
    : model_(model),
      params_(params),
      seeding_(model, params_),
      ranking_(params_),
      budget_(params.work),
      pending_(model, params.decorrelation_distance) {}

void HypothesisBank::clear() {
  ++beginnings_;
  hypotheses_.clear();
  closed_null_score_ = 0.0;
  round_.scene.clear();
  best_sonar_ = 0.0;
  phase_ = Phase::kIdle;
  seeding_.abort();
  pending_.clear();
}

std::size_t HypothesisBank::max_echoes() const {
  return std::max(kFewEchoes, static_cast<std::size_t>(kLongestRound) * static_cast<std::size_t>(params_.work) /
                                  std::max<std::size_t>(1, kUnitsPerEcho * hypotheses_.size()));
}

void HypothesisBank::observe(const SightingFrame& frame, const ObjectTracks& tracks, const OdometryReading& odometry,
                             double odometer) {
  pending_.add_image(tracks.forgotten());
  if (phase_ == Phase::kIdle) {
    close_scene();
    const ObjectTracks before = std::exchange(round_.scene, tracks);
    round_.images_of_sighting.clear();
    for (std::size_t i = 0; i < frame.sightings.size(); ++i) {
      const ObjectTrack& object = tracks.seen(i);
      const auto known = std::find_if(before.objects().begin(), before.objects().end(),
                                      [&](const ObjectTrack& o) { return o.id == object.id; });
      const int images = object.frames - (known == before.objects().end() ? 0 : known->frames);
      round_.images_of_sighting.push_back(std::clamp(images, 1, EvidenceRound::kMaxImages));
    }
    round_.has_image = true;
    round_.frame = frame;
    round_.odometry = odometry;
    round_.odometer = odometer;
    begin_round();
  }
  compare_next();
}

void HypothesisBank::wait() {
  if (phase_ == Phase::kIdle) {
    close_scene();
    round_.has_image = false;
    round_.frame = {};
    begin_round();
  }
  compare_next();
}

void HypothesisBank::close_scene() {
  if (pending_.motion().settles) {
    closed_null_score_ += score_of_misfits(round_.scene.objects(), !model_.is_complete, params_);
    round_.scene.clear();
  }
}

void HypothesisBank::begin_round() {
  pending_.hand_over(round_);
  if (!model_.walls.has_walls() || hypotheses_.empty()) {
    round_.echoes.clear();
  }
  round_best_sonar_ = -1e18;
  if (round_.has_image) {
    closed_null_score_ += score_of_misfits(round_.forgotten, !model_.is_complete, params_);
    comparer_.emplace(round_.frame, round_.odometry.linear, round_.odometry.angular, model_, params_);
  }
  next_ = 0;
  phase_ = Phase::kCompare;
}

void HypothesisBank::compare_next() {
  if (phase_ != Phase::kCompare) {
    return;
  }
  const int cost = 2 + (round_.has_image ? 1 + static_cast<int>(round_.frame.sightings.size()) : 0) +
                   kUnitsPerEcho * static_cast<int>(round_.echoes.size());
  while (next_ < hypotheses_.size()) {
    if (budget_.is_spent()) {
      return;
    }
    budget_.spend(cost);
    visit(hypotheses_[next_]);
    if (may_lead(hypotheses_[next_])) {
      round_best_sonar_ = std::max(round_best_sonar_, hypotheses_[next_].sonar);
    }
    ++next_;
  }
  if (!round_.echoes.empty()) {
    best_sonar_ = round_best_sonar_;
  }
  phase_ = Phase::kCompared;
}

// One that sonar alone could not bring before the leader must not be what all others are measured by: it would hold
// them all at the most that sonar can hold against a pose, and say nothing of which is the better one.
bool HypothesisBank::may_lead(const Hypothesis& hypothesis) const {
  return hypothesis.without_sonar() >= hypotheses_.front().without_sonar() - params_.sonar_cap;
}

void HypothesisBank::visit(Hypothesis& hypothesis) const {
  if (round_.motion.settles) {
    settle_all(hypothesis, params_);
  }
  if (round_.motion.has_moved) {
    move(hypothesis);
  }
  if (!round_.echoes.empty()) {
    hypothesis.sonar += params_.sonar_weight * log_likelihood_of_echoes(hypothesis.belief, round_.echoes, model_.walls,
                                                                        model_.sonar_half_angle);
  }
  if (round_.has_image) {
    compare(hypothesis);
  }
}

void HypothesisBank::move(Hypothesis& hypothesis) const {
  predict(hypothesis.belief, round_.motion.step.pose, round_.motion.step.covariance);
  if (model_.walls.has_walls() && round_.motion.distance > 0.0) {
    // probability that the robot's middle is at least 0.1 m from the next wall cell, as it must be
    const double room = model_.walls.distance_to_wall(hypothesis.belief.pose.position()) - 0.10;
    const double sigma = std::max(0.05, position_sigma(hypothesis.belief.covariance));
    hypothesis.walls += log_of_normal_tail(room / sigma) * round_.motion.distance / params_.wall_test_distance;
  }
}

void HypothesisBank::compare(Hypothesis& hypothesis) const {
  settle_what_is_over(hypothesis, round_.forgotten, round_.odometer, params_);
  const FrameComparison comparison = comparer_->compare(hypothesis.belief);
  for (std::size_t i = 0; i < round_.frame.sightings.size(); ++i) {
    // a sharp view tells more than one cut by the border
    const double sigma = largest_position_sigma(round_.frame.sightings[i].covariance);
    const double log_likelihood = comparison.of(i, round_.scene.seen(i));
    add_evidence(hypothesis, round_.scene.seen(i), comparison.fixture_of_sighting[i], log_likelihood,
                 1.0 / (1.0 + sigma * sigma / 0.01), round_.images_of_sighting[i]);
    if (comparison.fixture_of_sighting[i] >= 0 || log_likelihood > params_.misfit) {
      hypothesis.last_explained = round_.frame.utime;
    }
  }
  correct(hypothesis, comparison);
  add_absence(hypothesis, comparison.expected, comparison.missed, round_.odometer, round_.images);
}

void HypothesisBank::correct(Hypothesis& hypothesis, const FrameComparison& comparison) const {
  for (std::size_t i = 0; i < round_.frame.sightings.size(); ++i) {
    if (comparison.fixture_of_sighting[i] < 0) {
      continue;
    }
    hypothesis.last_match = round_.frame.utime;
    const FixtureSighting& sighting = round_.frame.sightings[i];
    const Fixture& fixture = model_.fixtures[comparison.fixture_of_sighting[i]];
    const Eigen::Matrix3d noise = comparer_->noise(i, comparison.fixture_of_sighting[i]) / round_.share;
    // several corrections in one image: linearise each at the pose the one before it left
    const Innovation innovation = innovate(hypothesis.belief, sighting, fixture, noise);
    luminav::correct(hypothesis.belief, innovation, noise);
  }
}

void HypothesisBank::seed(ObjectTracks& tracks) {
  // a round without an image has the objects of the last one, which have been used
  if (phase_ == Phase::kCompared && round_.has_image) {
    seeding_.begin(round_, tracks, best_sonar_ - 1.0);
    min_log_posterior_ =
        hypotheses_.empty() ? -1e18 : score_of(hypotheses_.front(), best_sonar_, params_) - params_.prune;
    phase_ = Phase::kSpawn;
  }
  spawn_next();
}

void HypothesisBank::spawn_next() {
  if (phase_ != Phase::kSpawn) {
    return;
  }
  while (!seeding_.is_complete() && !budget_.is_spent()) {
    for (Hypothesis& hypothesis : seeding_.next(hypotheses_, budget_)) {
      hypothesis.closed_score = closed_null_score_;
      if (score_of(hypothesis, best_sonar_, params_) >= min_log_posterior_) {
        add(std::move(hypothesis));
      }
    }
  }
}

void HypothesisBank::add(Hypothesis hypothesis) {
  hypothesis.id = next_id_++;
  hypothesis.log_posterior = score_of(hypothesis, best_sonar_, params_);
  hypothesis.sonar_part = held_by_sonar(hypothesis, best_sonar_, params_);
  hypotheses_.push_back(std::move(hypothesis));
}

void HypothesisBank::add_guess(const PoseBelief& belief, double log_prior) {
  Hypothesis guess;
  guess.belief = belief;
  guess.closed_score = closed_null_score_;
  guess.sonar = best_sonar_;
  guess.log_prior = log_prior;
  guess.belief.pose = standing(hypotheses_.size(), belief.pose);
  add(std::move(guess));
  ranking_.begin();
}

void HypothesisBank::place(std::size_t index, const PoseBelief& belief) {
  hypotheses_[index].belief = {standing(index, belief.pose), belief.covariance};
}

Pose2 HypothesisBank::standing(std::size_t index, const Pose2& now) const {
  Pose2 pose = pending_.motion().has_moved ? now * pending_.motion().step.pose.inverse() : now;
  if (awaits_visit(index) && round_.motion.has_moved) {
    pose = pose * round_.motion.step.pose.inverse();
  }
  return pose;
}

PoseBelief HypothesisBank::belief_now(std::size_t index) const {
  PoseBelief belief = hypotheses_[index].belief;
  if (awaits_visit(index) && round_.motion.has_moved) {
    predict(belief, round_.motion.step.pose, round_.motion.step.covariance);
  }
  if (pending_.motion().has_moved) {
    predict(belief, pending_.motion().step.pose, pending_.motion().step.covariance);
  }
  return belief;
}

void HypothesisBank::tidy() {
  if (phase_ == Phase::kIdle) {
    ranking_.begin();
    phase_ = Phase::kRank;
  }
  spawn_next();
  if (phase_ == Phase::kCompared || (phase_ == Phase::kSpawn && seeding_.is_complete())) {
    ranking_.begin();
    phase_ = Phase::kRank;
  }
  if (phase_ == Phase::kRank && ranking_.advance(hypotheses_, best_sonar_, budget_)) {
    phase_ = Phase::kIdle;
  }
}

}  // namespace luminav
