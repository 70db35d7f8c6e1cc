#pragma once

#include <vector>

#include "services/localizer/hypotheses/hypothesis_bank.hpp"
#include "services/localizer/model/pose_belief.hpp"

namespace luminav {

/// The first `max` of the bank's sorted hypotheses as shares of all, each carried `ahead` by odometry. What only the
/// sonars hold against a pose counts little.
std::vector<WeightedPose> weigh(const HypothesisBank& bank, const Pose2& ahead, std::size_t max);

/// Makes a belief as wide as the poses that are still possible lie apart.
void widen_over(const std::vector<WeightedPose>& possible, PoseBelief& belief);

}  // namespace luminav
