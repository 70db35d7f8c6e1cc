#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "services/planner/goals/goal_types.hpp"

namespace luminav {

/// Somebody for whom the controller waits on its path: what to say meanwhile, and when to leave them the corridor.
class PeopleInTheWay {
 public:
  /// A new stop.
  void reset() { has_left_ = false; }
  void restart_clock() { last_yield_ = 0; }
  /// Notes when the controller yields.
  void hear(const Situation& situation);
  /// What the report says while the robot follows a path: it changes only once the robot has set off, since somebody
  /// nearby stops it and lets it go several times a second.
  [[nodiscard]] std::optional<std::string> cause(const Situation& situation);
  [[nodiscard]] bool were_met_lately(std::int64_t now) const;
  /// True once on the way to a stop: who has met the same people for a minute goes round.
  [[nodiscard]] bool may_be_left();

 private:
  struct Waiting {
    Eigen::Vector2d place;  // [m] of the robot
    std::string cause;
  };
  std::int64_t last_yield_ = 0;  // [us] when it waited for somebody last
  std::optional<Waiting> waits_;
  bool has_left_ = false;
};

}  // namespace luminav
