#pragma once

#include <optional>
#include <vector>

#include "services/localizer/hypotheses/evidence_collector.hpp"
#include "services/localizer/hypotheses/frame_comparison.hpp"
#include "services/localizer/hypotheses/hypothesis.hpp"
#include "services/localizer/hypotheses/pose_hash.hpp"
#include "services/localizer/hypotheses/work_budget.hpp"
#include "services/localizer/model/observation_model.hpp"

namespace luminav {

/// Makes the hypotheses that objects of the scene allow: each object may be any fixture of its kind and size, turned as
/// its symmetry allows; a round one leaves a ring of poses, cut into turns. As many fixtures a step as the budget
/// allows; poses near one that is held already and explains the object are left out.
class HypothesisSeeding {
 public:
  /// Everything given must outlive this.
  HypothesisSeeding(const ObservationModel& model, const HypothesisParams& params) : model_(model), params_(params) {}

  /// Begins with the objects of a round, which must stay as it is until all are spawned, that have not been used for
  /// it. They are marked in `tracks`. Spawned ones have the score `sonar` of what was heard before, or that of a pose
  /// beside them if it is worse.
  void begin(const EvidenceRound& round, ObjectTracks& tracks, double sonar);
  void abort();
  [[nodiscard]] bool is_complete() const { return seed_object_ >= seed_objects_.size(); }
  /// The next ones that `known` does not hold yet, without prior. Until complete nobody but the caller appends to it.
  [[nodiscard]] std::vector<Hypothesis> next(const std::vector<Hypothesis>& known, WorkBudget& budget);

 private:
  void begin_seed_object(const std::vector<Hypothesis>& known, WorkBudget& budget);
  void spawn(const Fixture& fixture, const std::vector<Hypothesis>& known, std::vector<Hypothesis>& spawned) const;
  [[nodiscard]] bool explains_seed_object(const Hypothesis& hypothesis) const;
  [[nodiscard]] bool is_possible_place(const PoseBelief& belief) const;
  void add_scene_evidence(Hypothesis& hypothesis) const;

  const ObservationModel& model_;
  const HypothesisParams& params_;

  const EvidenceRound* round_ = nullptr;
  double sonar_ = 0.0;
  std::vector<std::size_t> seed_objects_;  // objects that hypotheses are made from
  std::size_t seed_object_ = 0;            // the one at work
  int fixture_ = 0;                        // next for it
  FixtureSighting sighting_;               // of it, from where the round's image was taken
  SightingFrame recent_;                   // what else was seen lately, carried there by odometry
  std::optional<FrameComparer> comparer_;
  std::optional<PoseHash> taken_;  // of hypotheses held when the seed object's turn came
};

}  // namespace luminav
