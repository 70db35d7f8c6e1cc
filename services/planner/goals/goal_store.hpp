#pragma once

#include <filesystem>
#include <luminav/goal_t.hpp>
#include <optional>
#include <string>

namespace luminav {

/// Where and when a planner runs; what is read of the machine is read by `main`.
struct GoalCircumstances {
  std::string boot;        // id of the machine's start; "" = unknown
  std::string building;    // its name
  std::int64_t utime = 0;  // [us] stamp of the robot
};

/// The goal that the planner is busy with, and how far it has come.
struct StoredGoal {
  goal_t goal;
  std::int32_t pose_index = 0;
  bool asks = false;  // paused, or the planner was ended in order: it goes on only when somebody says so
  GoalCircumstances kept;
};

/// Why a kept goal must not move the robot by itself, in one plain sentence; "" = it may: the planner crashed a moment
/// ago.
std::string objection_to_resuming(const StoredGoal& stored, const GoalCircumstances& now);

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
