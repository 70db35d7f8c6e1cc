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
  // from[i]: whose place i takes; those that are not kept go to the end. Along its cycles each moves once.
  std::vector<std::uint32_t> from;
  from.reserve(hypotheses.size());
  std::vector<bool> is_kept(hypotheses.size(), false);
  for (const Ranked& kept : kept_) {
    hypotheses[kept.index].log_posterior = kept.log_posterior;
    hypotheses[kept.index].sonar_part = held_by_sonar(hypotheses[kept.index], best_sonar, params_);
    is_kept[kept.index] = true;
    from.push_back(kept.index);
  }
  for (std::uint32_t i = 0; i < hypotheses.size(); ++i) {
    if (!is_kept[i]) {
      from.push_back(i);
    }
  }
  for (std::uint32_t start = 0; start < from.size(); ++start) {
    if (from[start] == start) {
      continue;
    }
    Hypothesis first = std::move(hypotheses[start]);
    std::uint32_t to = start;
    while (from[to] != start) {
      hypotheses[to] = std::move(hypotheses[from[to]]);
      to = std::exchange(from[to], to);
    }
    hypotheses[to] = std::move(first);
    from[to] = to;
  }
  hypotheses.resize(kept_.size());
}

}  // namespace luminav
