#pragma once

#include <cstdint>

#include "services/planner/goals/goal_types.hpp"

namespace luminav {

/// The stops of a goal, which one is next, and what becomes of one that failed.
class StopList {
 public:
  explicit StopList(const GoalParams& params) : params_(params) {}

  void begin(const GoalRequest& goal, int index);
  /// The request that resumes a goal gives it its id.
  void rename(std::int64_t id) { goal_.id = id; }
  void next();
  void reached() { failures_in_a_row_ = 0; }

  enum class AfterFailure { kTryAgain, kGoOn, kGiveUp };
  /// Counts a failure of the stop. `is_final`: no other stop will fare better.
  AfterFailure failed(bool is_final);

  [[nodiscard]] const GoalRequest& goal() const { return goal_; }
  [[nodiscard]] const GoalStop& stop() const { return goal_.stops[static_cast<std::size_t>(index_)]; }
  [[nodiscard]] int index() const { return index_; }
  [[nodiscard]] int count() const { return static_cast<int>(goal_.stops.size()); }
  [[nodiscard]] bool is_last() const { return !goal_.loop && index_ + 1 >= count(); }
  [[nodiscard]] int retries() const { return retries_; }
  [[nodiscard]] int skipped() const { return skipped_; }

  [[nodiscard]] double tolerance() const { return goal_.tolerance > 0.0 ? goal_.tolerance : params_.tolerance; }
  [[nodiscard]] double heading_tolerance() const {
    return goal_.heading_tolerance > 0.0 ? goal_.heading_tolerance : params_.heading_tolerance;
  }
  /// How far [m] from the stop a path may end so that the robot, stopping there, is within the tolerance.
  [[nodiscard]] double planned_tolerance() const;
  /// True if the robot stands at the stop, as it was asked for.
  [[nodiscard]] bool is_at_stop(const Pose2& world_from_robot) const;

 private:
  GoalParams params_;
  GoalRequest goal_;
  int index_ = 0;
  int retries_ = 0;  // of this stop
  int failures_in_a_row_ = 0;
  int skipped_ = 0;
};

}  // namespace luminav
