#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "services/localizer/hypotheses/evidence_collector.hpp"
#include "services/localizer/hypotheses/frame_comparison.hpp"
#include "services/localizer/hypotheses/hypothesis.hpp"
#include "services/localizer/hypotheses/hypothesis_ranking.hpp"
#include "services/localizer/hypotheses/hypothesis_seeding.hpp"
#include "services/localizer/hypotheses/sonar_evidence.hpp"
#include "services/localizer/hypotheses/work_budget.hpp"
#include "services/localizer/model/observation_model.hpp"

namespace luminav {

/// All poses that explain what was seen, each with a small Kalman filter and a score. Objects vote once each, however
/// many images showed them; walls, sonar and missing fixtures count beside.
///
/// Work goes in rounds: one image is compared with every hypothesis, new ones are spawned of it, the list is sorted.
/// Few hypotheses take one step for that; with thousands a round takes several, each with bounded work, and the images
/// that pass meanwhile are left out. In between the list is that of the round before: nothing is to be concluded from
/// it.
class HypothesisBank {
 public:
  /// The model must outlive this.
  HypothesisBank(const ObservationModel& model, const HypothesisParams& params);
  HypothesisBank(const HypothesisBank&) = delete;
  HypothesisBank& operator=(const HypothesisBank&) = delete;

  void clear();
  /// The work allowed in one step begins anew.
  void begin_step() { budget_.renew(); }
  /// How often the list began anew.
  [[nodiscard]] int beginnings() const { return beginnings_; }
  /// Moves all by an odometry step.
  void advance(const Pose2& delta) { pending_.advance(delta); }
  /// Moves all by a step that no odometry measured, with its covariance in the frame at its beginning. The scene is to
  /// be cleared: what is seen from now on are other objects.
  void bridge(const Pose2& step, const Eigen::Matrix3d& noise) { pending_.bridge(step, noise); }
  /// Echoes for the next round, in the robot frame of its image.
  void listen(const std::vector<PlacedEcho>& echoes) { pending_.listen(echoes); }
  /// Echoes that leave the next round short.
  [[nodiscard]] std::size_t max_echoes() const;
  /// One image: sightings (rolling shutter taken out) and the scene with them. Begins a round with it, or goes on with
  /// the one begun.
  void observe(const SightingFrame& frame, const ObjectTracks& tracks, const OdometryReading& odometry,
               double odometer);
  /// The same without an image.
  void wait();
  /// New poses from objects of the scene that have not yet been used for it.
  void seed(ObjectTracks& tracks);
  /// Sorts by score, merges doubles, gives up what is far behind. Ends the round.
  void tidy();
  /// A round has begun and has not ended: some hypotheses have not seen its image, or are still to be spawned.
  [[nodiscard]] bool is_busy() const { return phase_ != Phase::kIdle; }
  /// The image of the round that is going on or ended last.
  [[nodiscard]] const SightingFrame& frame() const { return round_.frame; }

  /// A guess from outside, of where the robot is now.
  void add_guess(const PoseBelief& belief, double log_prior);
  /// Puts a hypothesis where the robot is now by what others know of it.
  void place(std::size_t index, const PoseBelief& belief);

  [[nodiscard]] const std::vector<Hypothesis>& hypotheses() const { return hypotheses_; }
  [[nodiscard]] std::vector<Hypothesis>& hypotheses() { return hypotheses_; }
  /// Belief of a hypothesis carried to now; its own may be that of the round's image.
  [[nodiscard]] PoseBelief belief_now(std::size_t index) const;
  /// Score of "all that was seen is something else": what a pose not in the list would have.
  [[nodiscard]] double null_score() const {
    return closed_null_score_ + score_of_misfits(round_.scene.objects(), false, params_);
  }
  /// Units of work done in this step.
  [[nodiscard]] int work_done() const { return budget_.spent(); }

 private:
  enum class Phase { kIdle, kCompare, kCompared, kSpawn, kRank };

  /// Relative motion to what was seen is unknown: none of it is seen again.
  void close_scene();
  void begin_round();
  void compare_next();
  [[nodiscard]] bool may_lead(const Hypothesis& hypothesis) const;
  void visit(Hypothesis& hypothesis) const;
  void move(Hypothesis& hypothesis) const;
  void compare(Hypothesis& hypothesis) const;
  void correct(Hypothesis& hypothesis, const FrameComparison& comparison) const;
  void spawn_next();
  void add(Hypothesis hypothesis);
  /// Where a pose of now stood when the hypotheses did: at the round's image, or at the one before.
  [[nodiscard]] Pose2 standing(std::size_t index, const Pose2& now) const;
  [[nodiscard]] bool awaits_visit(std::size_t index) const { return phase_ == Phase::kCompare && index >= next_; }

  const ObservationModel& model_;
  HypothesisParams params_;
  std::vector<Hypothesis> hypotheses_;
  double closed_null_score_ = 0.0;  // of "all that was seen is something else", for objects that are over
  double best_sonar_ = 0.0;
  int next_id_ = 1;
  int beginnings_ = 0;

  // the round
  Phase phase_ = Phase::kIdle;
  EvidenceRound round_;
  std::optional<FrameComparer> comparer_;
  std::size_t next_ = 0;           // hypothesis to be compared with the image
  double round_best_sonar_ = 0.0;  // of those that may lead and have heard the round's echoes
  HypothesisSeeding seeding_;
  double min_log_posterior_ = 0.0;  // what is spawned with less would be given up at once
  HypothesisRanking ranking_;
  WorkBudget budget_;

  EvidenceCollector pending_;  // what the next round begins with
};

}  // namespace luminav
