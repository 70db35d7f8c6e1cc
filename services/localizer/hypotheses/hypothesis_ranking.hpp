#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/localizer/hypotheses/hypothesis.hpp"
#include "services/localizer/hypotheses/pose_hash.hpp"
#include "services/localizer/hypotheses/work_budget.hpp"

namespace luminav {

/// Sorts hypotheses by score, merges doubles and gives up what is far behind, a bounded part in each step. The list
/// itself changes only at the end, at once: until then it stays sorted by the scores of the time before.
class HypothesisRanking {
 public:
  explicit HypothesisRanking(const HypothesisParams& params) : params_(params) {}

  void begin();
  /// Goes on; true when the list is sorted. After a change of the list meanwhile, begin again.
  [[nodiscard]] bool advance(std::vector<Hypothesis>& hypotheses, double best_sonar, WorkBudget& budget);

 private:
  struct Ranked {
    double log_posterior;
    std::uint32_t index;
  };
  enum class Stage { kScore, kSort, kMerge, kArrange };

  void score_next(const std::vector<Hypothesis>& hypotheses, double best_sonar, WorkBudget& budget);
  void sort(WorkBudget& budget);
  void merge_next(const std::vector<Hypothesis>& hypotheses, WorkBudget& budget);
  void arrange(std::vector<Hypothesis>& hypotheses, double best_sonar);

  const HypothesisParams& params_;
  Stage stage_ = Stage::kScore;
  std::vector<Ranked> ranked_;
  std::size_t next_ = 0;
  int eligible_ = 0;                // good enough so far, doubles counted in
  std::vector<Ranked> kept_;        // best first
  std::optional<PoseHash> places_;  // of those
};

}  // namespace luminav
