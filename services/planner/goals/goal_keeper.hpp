#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "services/planner/goals/goal_store.hpp"

namespace luminav {

/// How far the goal that was accepted last has come.
struct GoalProgressNow {
  bool is_active = false;
  std::int32_t stop_index = 0;
  bool is_paused = false;
};

/// Keeps the goal under way on disk, as often as it has to be, and forgets it when it is over.
class GoalKeeper {
 public:
  /// "" = keeps nothing. `here` is written beside it, with the stamp of the time.
  GoalKeeper(const std::filesystem::path& folder, GoalCircumstances here);

  void accept(const goal_t& goal) { accepted_ = goal; }
  [[nodiscard]] const goal_t& accepted() const { return accepted_; }
  /// It stands so now [us].
  void update(const GoalProgressNow& progress, std::int64_t now);
  /// The planner is ended in order: a goal under way asks before it goes on.
  void end(const GoalProgressNow& progress, std::int64_t now);
  /// What a planner before this one has left.
  [[nodiscard]] std::optional<StoredGoal> recall() const { return store_.recall(); }
  /// What it has left lies in the store still.
  void leave(const StoredGoal& stored) { kept_ = stored; }
  /// Why the last one could not be kept, a sentence; "" = it could.
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  [[nodiscard]] bool is_due(const GoalProgressNow& progress, std::int64_t now) const;
  void keep(std::int32_t stop_index, bool asks, std::int64_t now);

  GoalStore store_;
  GoalCircumstances here_;
  goal_t accepted_{};               // as it came
  std::optional<StoredGoal> kept_;  // as it lies in the store
  std::string error_;
};

}  // namespace luminav
