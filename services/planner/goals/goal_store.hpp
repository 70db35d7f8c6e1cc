#pragma once

#include <filesystem>
#include <luminav/goal_t.hpp>
#include <optional>

namespace luminav {

/// The goal that the planner is busy with, and how far it has come.
struct StoredGoal {
  goal_t goal;
  std::int32_t pose_index = 0;
};

/// Keeps the goal list over a restart: the message as it came, so that its fingerprint guards the format.
class GoalStore {
 public:
  /// "" = keeps nothing.
  explicit GoalStore(const std::filesystem::path& folder);

  /// Throws std::runtime_error when the folder cannot be written.
  void keep(const StoredGoal& stored) const;
  void forget() const;
  /// Nothing when there is no goal, or the file is damaged.
  [[nodiscard]] std::optional<StoredGoal> recall() const;

 private:
  std::filesystem::path file_;
};

}  // namespace luminav
