#pragma once

#include <vector>

#include "tests/unit/localizer/trial.hpp"

namespace luminav::testing {

/// What many drives came to.
class TrialSummary {
 public:
  /// `kidnaps` per drive, `duration` [s] of each.
  TrialSummary(int kidnaps, double duration) : kidnaps_(kidnaps), duration_(duration) {}

  void add(const TrialResult& result);
  /// Found, rightly at first, never confidently wrong, and found again after each carry.
  [[nodiscard]] bool is_flawless(const TrialResult& result) const;
  /// Several lines; `searcher` is what searches for the pose.
  void print(const char* searcher) const;

 private:
  void print_starts() const;
  void print_tracking() const;
  void print_steps(const char* searcher) const;

  int kidnaps_;
  double duration_;  // [s]
  long runs_ = 0;
  long localized_ = 0;
  long correct_ = 0;
  long at_end_ = 0;
  TrialResult sum_;                 // of what can be added up
  std::vector<double> distances_;   // [m] until localized
  std::vector<double> times_;       // [s] likewise
  std::vector<double> resolvable_;  // [m]
};

}  // namespace luminav::testing
