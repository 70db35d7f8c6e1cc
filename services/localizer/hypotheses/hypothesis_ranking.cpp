#include "services/localizer/hypotheses/hypothesis_ranking.hpp"

#include <algorithm>
#include <utility>

namespace luminav {

void HypothesisRanking::begin() {
  stage_ = Stage::kScore;
  ranked_.clear();
  kept_.clear();
  places_.reset();
  next_ = 0;
  eligible_ = 0;
}

bool HypothesisRanking::advance(std::vector<Hypothesis>& hypotheses, double best_sonar, WorkBudget& budget) {
  if (stage_ == Stage::kScore) {
    score_next(hypotheses, best_sonar, budget);
  }
  const int count = static_cast<int>(ranked_.size());
  if (stage_ == Stage::kSort && budget.allows(count / 2)) {
    sort(budget);
  }
  if (stage_ == Stage::kMerge) {
    merge_next(hypotheses, budget);
  }
  if (stage_ != Stage::kArrange || !budget.allows(count / 2)) {
    return false;
  }
  budget.spend(count / 2);
  arrange(hypotheses, best_sonar);
  begin();
  return true;
}

void HypothesisRanking::score_next(const std::vector<Hypothesis>& hypotheses, double best_sonar, WorkBudget& budget) {
  ranked_.reserve(hypotheses.size());
  while (ranked_.size() < hypotheses.size()) {
    if (budget.is_spent()) {
      return;
    }
    const Hypothesis& hypothesis = hypotheses[ranked_.size()];
    ranked_.push_back({score_of(hypothesis, best_sonar, params_), static_cast<std::uint32_t>(ranked_.size())});
    budget.spend(1);
  }
  stage_ = Stage::kSort;
}

void HypothesisRanking::sort(WorkBudget& budget) {
  std::sort(ranked_.begin(), ranked_.end(), [](const Ranked& a, const Ranked& b) {
    return a.log_posterior > b.log_posterior || (a.log_posterior == b.log_posterior && a.index < b.index);
  });
  budget.spend(static_cast<int>(ranked_.size()) / 2);
  places_.emplace(ranked_.size());
  kept_.reserve(ranked_.size());
  stage_ = Stage::kMerge;
}

void HypothesisRanking::merge_next(const std::vector<Hypothesis>& hypotheses, WorkBudget& budget) {
  for (; next_ < ranked_.size(); ++next_) {
    if (budget.is_spent()) {
      return;
    }
    budget.spend(1);
    const Ranked& ranked = ranked_[next_];
    const Hypothesis& hypothesis = hypotheses[ranked.index];
    if (ranked.log_posterior < ranked_.front().log_posterior - params_.prune || hypothesis.walls < -15.0 ||
        !hypothesis.belief.covariance.allFinite() || eligible_ >= params_.max) {
      continue;
    }
    ++eligible_;
    // the better of two that came together stays
    const Pose2& pose = hypothesis.belief.pose;
    const bool is_double = places_->any_near(
        pose, [&](std::size_t i) { return is_same_place(hypotheses[kept_[i].index].belief.pose, pose, params_); });
    if (!is_double) {
      places_->add(pose);
      kept_.push_back(ranked);
    }
  }
  stage_ = Stage::kArrange;
}

void HypothesisRanking::arrange(std::vector<Hypothesis>& hypotheses, double best_sonar) {
  std::vector<Hypothesis> arranged;
  arranged.reserve(kept_.size());
  for (const Ranked& kept : kept_) {
    Hypothesis& hypothesis = arranged.emplace_back(std::move(hypotheses[kept.index]));
    hypothesis.log_posterior = kept.log_posterior;
    hypothesis.sonar_part = held_by_sonar(hypothesis, best_sonar, params_);
  }
  hypotheses = std::move(arranged);
}

}  // namespace luminav
