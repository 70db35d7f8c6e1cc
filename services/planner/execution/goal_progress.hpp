#pragma once

#include <cstdint>

#include "services/planner/goals/goal_types.hpp"

namespace luminav {

/// Watches whether the robot gets nearer to its stop, and counts the new plans made because it did not.
class GoalProgress {
 public:
  explicit GoalProgress(const GoalParams& params) : params_(params) {}

  /// A new stop, or a new try.
  void reset() { attempts_ = missed_ = 0; }
  void forget_attempts() { attempts_ = 0; }
  void restart_clock(std::int64_t now) { since_ = first_attempt_ = now; }

  /// The robot sets off on a path of `length` [m].
  void begin_path(double length, std::int64_t now);
  /// It goes on by another path: planning is no progress.
  void replace_path(double length);
  /// True if the robot has come no nearer for too long; more patient while the controller moves it.
  [[nodiscard]] bool has_stalled(double distance_left, const Situation& situation);
  void count_attempt(std::int64_t now);
  /// Counts that the controller calls a place the stop that is not. False if that happened too often.
  [[nodiscard]] bool count_missed();

  [[nodiscard]] int attempts() const { return attempts_; }
  /// It has tried for a minute.
  [[nodiscard]] bool has_tried_long(std::int64_t now) const;
  /// Planned so often and for so long that it is stuck. `by_people`: people in the way are no proof of that yet.
  [[nodiscard]] bool is_stuck(bool by_people, std::int64_t now) const;

 private:
  GoalParams params_;
  std::int64_t since_ = 0;          // [us] of the last progress
  double left_ = 0.0;               // [m] distance left then
  int attempts_ = 0;                // plans without progress
  double attempts_left_ = 0.0;      // [m] distance left when the attempts were counted from
  std::int64_t first_attempt_ = 0;  // [us]
  int missed_ = 0;
};

}  // namespace luminav
