#pragma once

#include <cstdint>

#include "services/planner/goals/goal_types.hpp"

namespace luminav {

/// Measures how long the pose has been lost, and counts how often without progress.
class PoseLosses {
 public:
  explicit PoseLosses(const GoalParams& params) : params_(params) {}

  /// A goal begins or goes on: no pose has been seen for it yet.
  void begin() { last_tracking_ = 0; }
  /// A new stop.
  void reset() { losses_ = 0; }
  void track(std::int64_t now) { last_tracking_ = now; }
  /// Lost for so short a time that the robot does not go searching.
  [[nodiscard]] bool is_brief(std::int64_t now) const;
  /// Counts a loss, `distance_left` [m] before the stop. False if there were too many of them without progress.
  [[nodiscard]] bool count(double distance_left);
  [[nodiscard]] bool has_lost() const { return losses_ > 0; }

 private:
  GoalParams params_;
  std::int64_t last_tracking_ = 0;  // [us] 0 = not since the goal was taken up
  int losses_ = 0;
  double loss_left_ = 0.0;  // [m] distance left when losses were counted from
};

}  // namespace luminav
