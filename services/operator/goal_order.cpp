#include "services/operator/goal_order.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "services/common/geometry/angle.hpp"
#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

template <std::size_t N>
std::string name_in(const std::array<const char*, N>& names, int index) {
  return index >= 0 && static_cast<std::size_t>(index) < N ? names[static_cast<std::size_t>(index)]
                                                           : fmt::format("state {}", index);
}

std::optional<Outcome> outcome_of(int state) {
  switch (state) {
    case navigation_status_t::STATE_ARRIVED:
      return Outcome::kArrived;
    case navigation_status_t::STATE_NO_PATH:
      return Outcome::kNoPath;
    case navigation_status_t::STATE_BLOCKED:
      return Outcome::kBlocked;
    case navigation_status_t::STATE_STUCK:
      return Outcome::kStuck;
    case navigation_status_t::STATE_CANCELLED:
      return Outcome::kCancelled;
    case navigation_status_t::STATE_LOST:
      return Outcome::kLost;
    default:
      return std::nullopt;
  }
}

/// Whether a status under another id is still about the goal of the one before: pausing, resuming and cancelling have
/// ids of their own.
bool is_same_goal(const navigation_status_t& before, const navigation_status_t& now) {
  const bool same_target = before.has_target && now.has_target && before.x == now.x && before.y == now.y &&
                           before.has_theta == now.has_theta && before.theta == now.theta;
  return same_target || now.state == navigation_status_t::STATE_CANCELLED;
}

}  // namespace

std::string to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kArrived:
      return "arrived";
    case Outcome::kNobodyAnswers:
      return "nobody answers";
    case Outcome::kNoPath:
      return "no path";
    case Outcome::kBlocked:
      return "blocked";
    case Outcome::kStuck:
      return "stuck";
    case Outcome::kCancelled:
      return "cancelled";
    case Outcome::kLost:
      return "lost";
    case Outcome::kReplaced:
      return "replaced";
    case Outcome::kPlannerSilent:
      return "the planner fell silent";
    case Outcome::kPaused:
      return "paused";
    case Outcome::kResumed:
      return "goes on";
    case Outcome::kNothingToDo:
      return "nothing to do";
    case Outcome::kInterrupted:
      return "interrupted";
  }
  return "";
}

std::string navigation_state_name(int state) {
  static constexpr std::array kNames{"idle",    "localizing", "planning", "following", "waiting", "arrived",
                                     "no path", "blocked",    "stuck",    "cancelled", "lost",    "paused"};
  return name_in(kNames, state);
}

std::string pose_state_name(int state) {
  static constexpr std::array kNames{"lost", "ambiguous", "tracking"};
  return name_in(kNames, state);
}

std::string control_state_name(int state) {
  static constexpr std::array kNames{"idle",     "wandering", "following", "turning", "at goal",
                                     "yielding", "escaping",  "stuck",     "stopped", "teleoperated"};
  return name_in(kNames, state);
}

GoalOrder::GoalOrder(lcm::LCM& lcm, const goal_t& goal, std::optional<CommandKey> key)
    : commands_(lcm, key), subscriber_(lcm), goal_(goal) {
  subscriber_.on(channels::kNavigationStatus, &GoalOrder::on_navigation_status, this);
  subscriber_.on(channels::kPose, &GoalOrder::on_pose, this);
}

void GoalOrder::tick() {
  if (outcome_) {
    return;
  }
  if (++silent_ticks_ > kAnswerTicks) {
    if (is_echoed_) {
      finish(Outcome::kPlannerSilent, "no NAVIGATION_STATUS for 5 s");
    } else {
      finish(Outcome::kNobodyAnswers,
             status_ ? "the planner does not take up the request" : "no planner answers: is the system running?");
    }
    return;
  }
  if (!is_echoed_) {
    commands_.publish(channels::kGoal, goal_);
  }
}

void GoalOrder::cancel(std::int64_t id) {
  goal_t request{};
  request.utime = id;
  request.id = id;
  request.action = goal_t::ACTION_CANCEL;
  goal_ = request;
  is_echoed_ = false;
  silent_ticks_ = 0;
  outcome_.reset();
  commands_.publish(channels::kGoal, goal_);
}

void GoalOrder::finish(Outcome outcome, const std::string& cause) {
  outcome_ = outcome;
  cause_ = cause;
}

void GoalOrder::finish_action(const navigation_status_t& echo) {
  if (goal_.action == goal_t::ACTION_CANCEL) {
    finish(Outcome::kCancelled, echo.cause);
  } else if (echo.state == navigation_status_t::STATE_IDLE || outcome_of(echo.state)) {
    finish(Outcome::kNothingToDo, "the robot has no goal");
  } else if (goal_.action == goal_t::ACTION_RESUME) {
    finish(Outcome::kResumed, echo.cause);
  } else if (echo.state == navigation_status_t::STATE_PAUSED) {
    finish(Outcome::kPaused, echo.cause);
  }
}

void GoalOrder::on_pose(const pose_t& message) {
  pose_ = message;
}

void GoalOrder::on_navigation_status(const navigation_status_t& message) {
  const std::optional<navigation_status_t> before = std::exchange(status_, message);
  if (outcome_) {
    return;
  }
  if (message.goal_id != goal_.id) {
    if (!is_echoed_) {
      if (message.goal_id > goal_.id) {  // the planner takes only ids that grow, and another's clock was ahead of ours
        goal_.id = message.goal_id + 1 + goal_.id % 1000;
      }
      return;
    }
    if (!is_same_goal(*before, message)) {
      finish(Outcome::kReplaced, fmt::format("goal {} took its place", message.goal_id));
      return;
    }
    goal_.id = message.goal_id;
  }
  is_echoed_ = true;
  silent_ticks_ = 0;
  if (goal_.action != goal_t::ACTION_GO) {
    finish_action(message);
    return;
  }
  if (const std::optional<Outcome> outcome = outcome_of(message.state)) {
    finish(*outcome, message.cause);
  }
}

std::string GoalOrder::progress() const {
  if (!is_echoed_ || !status_) {
    return "asking the planner";
  }
  std::string line = navigation_state_name(status_->state);
  if (pose_) {
    line += pose_->state == pose_t::STATE_TRACKING
                ? fmt::format(" | at ({:.2f}, {:.2f}) {:.0f} deg", pose_->x, pose_->y, degrees(pose_->theta))
                : fmt::format(" | pose {}", pose_state_name(pose_->state));
  }
  if (status_->distance_left > 0.0) {
    line += fmt::format(" | {:.1f} m left", status_->distance_left);
  }
  if (!status_->cause.empty()) {
    line += " | " + status_->cause;
  }
  return line;
}

}  // namespace luminav
