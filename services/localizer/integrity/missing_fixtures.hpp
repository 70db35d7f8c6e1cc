#pragma once

#include <map>
#include <optional>
#include <vector>

#include "services/localizer/integrity/kidnap_opportunity.hpp"
#include "services/localizer/integrity/tracking_rules.hpp"
#include "services/localizer/model/observation_model.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/tracking/fixture_matching.hpp"

namespace luminav {

/// Counts the images since the last match that lack a fixture which the tracked pose predicts in them.
class MissingFixtures {
 public:
  /// The model must outlive this.
  MissingFixtures(const ObservationModel& model, const TrackingRules& rules) : model_(model), rules_(rules) {}

  /// An image that shows fixtures where the pose has them.
  void match(const std::vector<FixtureMatch>& matches, const PoseBelief& belief);
  /// An image that shows none there. True if one ought to be in view.
  [[nodiscard]] bool look(const SightingFrame& frame, const PoseBelief& belief, const KidnapOpportunity& kidnap);
  /// The fixture whose absence puts the pose in doubt; `distance_since_match` [m].
  [[nodiscard]] std::optional<int> find(double distance_since_match, bool was_kidnapped) const;
  /// Restarts the counts.
  void restart();
  /// Forgets also what the last match showed.
  void clear();

 private:
  const ObservationModel& model_;
  TrackingRules rules_;
  std::map<int, int> images_;          // since the last match, that ought to show a fixture and do not
  std::optional<int> vanished_;        // fixture that is no longer seen from where it was seen
  std::map<int, double> seen_lately_;  // fixtures of the last match, and which share of them was in view
};

}  // namespace luminav
