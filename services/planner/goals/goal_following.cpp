#include "services/planner/goals/goal_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/planner/goals/goal_sentences.hpp"

namespace luminav {
namespace {

constexpr int kArrivalFailures = 3;     // the controller says "there" and the pose says "no"
constexpr double kSuspectAhead = 0.45;  // [m] on the path where something stopped the robot
constexpr double kPeopleAhead = 1.3;    // [m] on the path: the middle of where people are who do not let it pass,
constexpr double kPeopleRadius = 0.9;  // [m] with which they fill a corridor of 2.4 m and leave the robot its own place
constexpr double kSetOff = 0.05;       // [m] that the robot has driven when it no longer waits for somebody, ...
constexpr double kLetGo = 1.0;         // [s] ... or for so long nobody has been in its way

}  // namespace

// On the way: arrived, blocked, better way found, or no progress.

void GoalCycle::update_following(const Situation& situation) {
  at_ = nearest_ahead(path_.points, at_, situation.world_from_robot.position());
  report_.distance_left = polyline_length(remaining(situation.world_from_robot));
  watch_yielding(situation);
  report_.state = waits_ ? NavigationState::kWaiting : NavigationState::kFollowing;
  report_.cause = !situation.can_move ? situation.cannot_move : waits_ ? waits_->cause : "";
  check_arrival(situation);
  if (phase_ == Phase::kFollowing) {
    check_path(situation);
  }
  if (phase_ == Phase::kFollowing) {
    check_progress(situation);
  }
}

// Somebody nearby stops the robot and lets it go several times a second. What it says changes only once it has set off.
void GoalCycle::watch_yielding(const Situation& situation) {
  const Eigen::Vector2d robot = situation.world_from_robot.position();
  if (situation.control && situation.control->yielding) {
    waits_ = {robot, situation.control->reason};
  } else if (waits_ && ((robot - waits_->place).norm() > kSetOff || seconds_since(last_yield_) > kLetGo)) {
    waits_.reset();
  }
}

bool GoalCycle::is_at_stop(const Pose2& pose) const {
  const bool near = (pose.position() - stop().pose.position()).norm() <= tolerance() + 1e-6;
  const bool turned =
      !stop().has_theta || std::abs(wrap_angle(pose.theta - stop().pose.theta)) <= heading_tolerance() + 1e-6;
  return near && turned;
}

void GoalCycle::check_arrival(const Situation& situation) {
  if (!is_at_end(situation)) {
    return;
  }
  if (is_at_stop(situation.world_from_robot)) {
    reached_stop();
    return;
  }
  const Pose2& pose = situation.world_from_robot;
  if (++arrival_failures_ > kArrivalFailures) {
    fail_stop(NavigationState::kStuck, missed_sentence(pose, stop(), tolerance()));
    return;
  }
  ++report_.replans;
  last_plan_ = 0;
  enter(Phase::kPlanning, NavigationState::kPlanning, "the pose was corrected at the goal");
}

void GoalCycle::check_path(const Situation& situation) {
  const Eigen::Vector2d robot = situation.world_from_robot.position();
  const bool off_path = (path_.points[at_] - robot).norm() > params_.off_path;
  if ((!map_dirty_ && !off_path) || seconds_since(last_plan_) < params_.replan_period) {
    return;
  }
  refresh_space();
  last_plan_ = now_;
  const Polyline left = remaining(situation.world_from_robot);
  std::size_t beside = 0;
  while (beside < left.size() && (left[beside] - robot).norm() < kSkipBesideRobot) {
    ++beside;
  }
  const std::optional<std::size_t> blocked = planner_.first_blocked(left, beside);
  const Route route = planner_.plan({robot, stop().pose.position(), planned_tolerance()});
  if (blocked && look_at_gap(situation, route)) {
    return;
  }
  if (route.outcome != RouteOutcome::kFound) {
    if (blocked || off_path) {
      handle_no_route(situation, route);
    }
    return;  // the rest of the path is passable still: hold on to it
  }
  const bool better = route.cost < params_.keep_ratio * cost_of(planner_.space(), left);
  if (!blocked && !off_path && !better) {
    return;
  }
  const double limit = params_.detour_ratio * report_.distance_left + params_.detour_length;
  if (blocked && polyline_length(route.points) > limit) {
    hold(left, *blocked, report_.distance_left);
    return;
  }
  ++report_.replans;
  const std::int64_t since = progress_since_;
  follow(route);
  progress_since_ = since;  // planning is no progress
}

void GoalCycle::check_progress(const Situation& situation) {
  if (!situation.can_move || report_.distance_left < progress_left_ - params_.progress_length) {
    progress_since_ = now_;
    progress_left_ = report_.distance_left;
    if (report_.distance_left < attempt_left_ - kAttemptsForgotten) {
      attempts_ = 0;
      attempt_left_ = report_.distance_left;
    }
    return;
  }
  const bool controller_stuck = situation.control && situation.control->stuck;
  const bool controller_moves =
      situation.control && situation.control->seconds_without_progress < params_.no_progress_time && !controller_stuck;
  const double patience = controller_stuck   ? 0.3 * params_.no_progress_time
                          : controller_moves ? 3.0 * params_.no_progress_time
                                             : params_.no_progress_time;
  if (seconds_since(progress_since_) < patience) {
    return;
  }
  if (is_at_stop(situation.world_from_robot)) {
    reached_stop();
    return;
  }
  if (++attempts_ == 1) {
    first_attempt_ = now_;
  }
  // people come and go: who stands in the way is no proof that there is none
  const double tried = seconds_since(first_attempt_);
  const bool by_people = last_yield_ != 0 && seconds_since(last_yield_) < params_.people_memory;
  const bool is_long = tried >= (by_people ? params_.people_time : params_.stuck_time);
  if (attempts_ > params_.attempts && is_long) {
    const std::string why = !situation.control                  ? "the controller is silent"
                            : situation.control->reason.empty() ? "the controller does not say why"
                                                                : situation.control->reason;
    fail_stop(NavigationState::kStuck,
              fmt::format("no progress at ({:.1f}, {:.1f}), {:.1f} m before {}, after {} plans: {}",
                          situation.world_from_robot.x, situation.world_from_robot.y, report_.distance_left,
                          place_of(stop()), attempts_ - 1, why));
    return;
  }
  if (attempts_ >= 2 && !by_people) {
    suspect_ahead(situation);
  } else if (by_people && tried >= params_.stuck_time && !has_left_people_) {
    has_left_people_ = true;
    suspect_people(situation);
  }
  ++report_.replans;
  map_dirty_ = true;
  last_plan_ = 0;
  enter(Phase::kPlanning, NavigationState::kPlanning, "no progress: planning anew");
  plan(situation);
}

void GoalCycle::suspect_ahead(const Situation& situation) {
  const Eigen::Vector2d robot = situation.world_from_robot.position();
  for (std::size_t i = at_; i < path_.points.size(); ++i) {
    if ((path_.points[i] - robot).norm() >= kSuspectAhead) {
      suspect({.centre = path_.points[i]}, params_.suspect_time);
      return;
    }
  }
}

// Who has met the same people for a minute leaves them the corridor and goes round, if there is another way; where
// there is none, what is only suspected is dropped again.
void GoalCycle::suspect_people(const Situation& situation) {
  const Eigen::Vector2d robot = situation.world_from_robot.position();
  for (std::size_t i = at_; i < path_.points.size(); ++i) {
    if ((path_.points[i] - robot).norm() >= kPeopleAhead) {
      suspect({path_.points[i], kPeopleRadius}, params_.detour_memory);
      attempts_ = 0;
      return;
    }
  }
}

// Driven against something that no sonar hears, the robot must not come back to it by the same way.
void GoalCycle::suspect_touched(const Situation& situation) {
  const bool begins = situation.is_blocked && !was_blocked_;
  was_blocked_ = situation.is_blocked;
  if (begins && phase_ == Phase::kFollowing && situation.control && situation.control->follows) {
    suspect({.centre = situation.world_from_robot * Eigen::Vector2d(params_.touch_ahead, 0.0)}, params_.touch_time);
  }
}

void GoalCycle::suspect(const SuspectedObstacle& obstacle, double seconds) {
  suspects_.push_back({obstacle, now_ + static_cast<std::int64_t>(seconds * 1e6)});
  map_dirty_ = true;
}

}  // namespace luminav
