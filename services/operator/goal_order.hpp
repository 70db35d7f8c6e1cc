#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/goal_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/pose_t.hpp>
#include <optional>
#include <string>

#include "services/common/process/subscriber.hpp"

namespace luminav {

/// How a request ended, as an exit status.
enum class Outcome : int {
  kArrived = 0,
  kNobodyAnswers = 1,
  kNoPath = 3,
  kBlocked = 4,
  kStuck = 5,
  kCancelled = 6,
  kLost = 7,
  kReplaced = 8,       // somebody else sent another goal
  kPlannerSilent = 9,  // it had answered before
  kPaused = 10,
  kResumed = 11,
  kNothingToDo = 12,  // no goal to pause or to go on with
  kInterrupted = 130
};

/// A word for people: "arrived", "blocked", ...
std::string to_string(Outcome outcome);

/// One request to the planner and what becomes of it. Repeated with each `tick` until NAVIGATION_STATUS echoes its id.
/// Knows no clock: the owner calls `tick` at 5 Hz.
class GoalOrder {
 public:
  /// `goal.id` must be set; whatever is no new goal (cancel, pause, resume) is over as soon as it is echoed.
  GoalOrder(lcm::LCM& lcm, const goal_t& goal, std::optional<CommandKey> key = {});

  /// A fifth of a second has passed.
  void tick();
  /// Asks the planner to give the goal up, under a new id.
  void cancel(std::int64_t id);

  [[nodiscard]] std::optional<Outcome> outcome() const { return outcome_; }
  /// Why it ended, in the planner's words.
  [[nodiscard]] const std::string& cause() const { return cause_; }
  /// What goes on, one line: state, pose, distance left, sentence.
  [[nodiscard]] std::string progress() const;

 private:
  static constexpr int kAnswerTicks = 25;  // 5 s until somebody must have answered, and between two answers

  void on_navigation_status(const navigation_status_t& message);
  void on_pose(const pose_t& message);
  void finish(Outcome outcome, const std::string& cause);
  void finish_action(const navigation_status_t& echo);

  CommandPublisher commands_;
  Subscriber subscriber_;
  goal_t goal_;  // its id is the one by which the planner speaks of it
  bool is_echoed_ = false;
  int silent_ticks_ = 0;
  std::optional<navigation_status_t> status_;
  std::optional<pose_t> pose_;
  std::optional<Outcome> outcome_;
  std::string cause_;
};

/// Name of a state of NAVIGATION_STATUS.
std::string navigation_state_name(int state);
/// Name of a state of POSE.
std::string pose_state_name(int state);
/// Name of a state of CONTROL_STATUS.
std::string control_state_name(int state);

}  // namespace luminav
