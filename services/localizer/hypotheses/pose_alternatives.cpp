#include "services/localizer/hypotheses/pose_alternatives.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

// The search must not drop poses that only sonar speaks against, since boxes are on no map. But they must not weigh as
// much as the leader: the robot would spend minutes looking for a door that only they predict.
constexpr double kMaxBySonar = 4.0;

}  // namespace

std::vector<WeightedPose> weigh(const HypothesisBank& bank, const Pose2& ahead, std::size_t max) {
  const std::vector<Hypothesis>& hypotheses = bank.hypotheses();
  std::vector<WeightedPose> result;
  if (hypotheses.empty()) {
    return result;
  }
  const auto score = [&](const Hypothesis& hypothesis) {
    return hypothesis.log_posterior - hypothesis.sonar_part + std::max(-kMaxBySonar, hypothesis.sonar_part);
  };
  double best = score(hypotheses.front());
  for (const Hypothesis& hypothesis : hypotheses) {
    best = std::max(best, score(hypothesis));
  }
  double sum = 0.0;
  for (const Hypothesis& hypothesis : hypotheses) {
    sum += std::exp(score(hypothesis) - best);
  }
  for (std::size_t i = 0; i < std::min(max, hypotheses.size()); ++i) {
    result.push_back({bank.belief_now(i).pose * ahead, std::exp(score(hypotheses[i]) - best) / sum,
                      position_sigma(hypotheses[i].belief.covariance)});
  }
  return result;
}

void widen_over(const std::vector<WeightedPose>& possible, PoseBelief& belief) {
  for (const WeightedPose& other : possible) {
    const Eigen::Vector2d offset = other.pose.position() - belief.pose.position();
    belief.covariance.topLeftCorner<2, 2>() += other.weight * offset * offset.transpose();
    belief.covariance(2, 2) += other.weight * std::pow(wrap_angle(other.pose.theta - belief.pose.theta), 2);
  }
}

}  // namespace luminav
