#include "tests/evaluation/runs/mission.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <luminav/goal_t.hpp>
#include <luminav/initial_pose_t.hpp>
#include <luminav/teleop_command_t.hpp>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kRepeat = 200'000;     // [us] requests go out at 5 Hz until echoed
constexpr std::int64_t kSettled = 1'000'000;  // [us] a final state must last that long: replanning may pass through one
constexpr std::int64_t kForeignRest = 5'000'000;  // [us] that a person has to go on with what he began
constexpr std::int64_t kGoalDelay = 1'000'000;    // [us] between the first truth and the first request

// What "arrived" promises: the planner's heading_tolerance of 5 degrees by its own belief, and three times the 2
// degrees RMS that the localizer may be off by in a building that was not surveyed.
constexpr double kHeadingTolerance = radians(5.0 + 3.0 * 2.0);  // [rad] by the truth

bool is_final(std::int8_t state) {
  switch (state) {
    case navigation_status_t::STATE_ARRIVED:
    case navigation_status_t::STATE_NO_PATH:
    case navigation_status_t::STATE_BLOCKED:
    case navigation_status_t::STATE_STUCK:
    case navigation_status_t::STATE_CANCELLED:
    case navigation_status_t::STATE_LOST:
      return true;
    default:
      return false;
  }
}

}  // namespace

Mission::Mission(lcm::LCM& lcm, const Scenario& scenario, bool patrol)
    : lcm_(lcm), scenario_(scenario), patrol_(patrol), subscriber_(lcm) {
  subscriber_.on(channels::kSimTruth, &Mission::on_truth, this);
  subscriber_.on(channels::kNavigationStatus, &Mission::on_navigation, this);
  subscriber_.on(channels::kRobotStatus, &Mission::on_robot_status, this);
  subscriber_.on(channels::kPose, &Mission::on_pose, this);
}

bool Mission::is_finished() const {
  if (has_goal_left()) {
    return false;
  }
  double total = 0.0;
  for (const DriveStep& step : scenario_.drives) {
    total += step.duration;
  }
  const bool driven =
      scenario_.drives.empty() ||
      (drive_started_ != 0 && truth_ && static_cast<double>(truth_->utime - drive_started_) * 1e-6 > total + 1.0);
  return driven && !(scenario_.goals.empty() && scenario_.drives.empty());
}

void Mission::on_truth(const sim_truth_t& truth) {
  if (truth_ && goal_id_ != 0 && !truth.carried) {
    driven_.back() += std::hypot(truth.x - truth_->x, truth.y - truth_->y);
  }
  truth_ = truth;
  if (!truth.carried && !is_bumped_after_end(truth.utime)) {
    standing_ = truth;
  }
  if (first_utime_ == 0) {
    first_utime_ = truth.utime;
  }
  if (truth.utime - first_utime_ < kGoalDelay) {
    return;
  }
  if (scenario_.start_known) {
    tell_start(truth);
  }
  if (has_goal_left()) {
    if (goal_id_ == 0) {
      goal_id_ = truth.utime;
      requested_at_ = truth.utime;
      request_poses_.push_back({truth.x, truth.y, truth.theta});
      driven_.push_back(0.0);
    }
    if (is_interrupted()) {
      watch_foreign_goal(truth.utime);
    } else {
      send_goal(truth.utime);
      watch_goal(truth);
    }
  }
}

// Ids grow: ours must be newer than that of whoever came before. Whoever comes after it is right.
void Mission::tell_start(const sim_truth_t& truth) {
  const std::int64_t echo = pose_ ? pose_->initial_pose_id : 0;
  const std::int64_t utime = truth.utime;
  if (start_id_ == 0) {
    start_id_ = std::max(first_utime_, echo + 1);
  }
  if (echo >= start_id_ || utime - first_utime_ > 60'000'000 || (utime - first_utime_) % kRepeat >= 10'000) {
    return;
  }
  initial_pose_t message{};
  message.utime = utime;
  message.id = start_id_;
  message.x = truth.x;
  message.y = truth.y;
  message.theta = truth.theta;
  message.covariance[0] = message.covariance[4] = 0.1 * 0.1;
  message.covariance[8] = radians(5.0) * radians(5.0);
  lcm_.publish(channels::kInitialPose, &message);
}

void Mission::send_goal(std::int64_t utime) {
  if ((navigation_ && navigation_->goal_id == goal_id_) || utime - last_sent_ < kRepeat) {
    return;
  }
  last_sent_ = utime;
  const ScenarioGoal& wanted = goal(results_.size());
  goal_t message{};
  message.utime = utime;
  message.id = goal_id_;
  message.action = goal_t::ACTION_GO;
  message.policy = goal_t::POLICY_STOP;
  message.count = 1;
  goal_pose_t pose{};
  pose.place = wanted.place;
  pose.x = wanted.pose.x;
  pose.y = wanted.pose.y;
  pose.has_theta = wanted.has_theta;
  pose.theta = wanted.pose.theta;
  message.poses.push_back(pose);
  lcm_.publish(channels::kGoal, &message);
}

void Mission::watch_goal(const sim_truth_t& truth) {
  if (navigation_ && navigation_->goal_id == goal_id_ && navigation_->state == navigation_status_t::STATE_PAUSED) {
    goal_id_ = truth.utime;  // a planner that was ended in order asks: yes, there
  }
  if (!navigation_ || navigation_->goal_id != goal_id_ || !is_final(navigation_->state)) {
    ended_since_ = 0;
    return;
  }
  if (ended_since_ == 0) {
    ended_since_ = truth.utime;
  }
  const bool arrived = navigation_->state == navigation_status_t::STATE_ARRIVED;
  // who is carried off or bumped upon its arrival had arrived where it stood
  if (truth.utime - ended_since_ >= kSettled || (arrived && truth.carried)) {
    finish_goal(standing_.value_or(truth), arrived);
  }
}

// Ids grow: ours must be newer than that of whoever came between.
void Mission::watch_foreign_goal(std::int64_t utime) {
  if (!is_final(navigation_->state)) {
    ended_since_ = 0;
  } else if (ended_since_ == 0) {
    ended_since_ = utime;
  } else if (utime - ended_since_ >= kForeignRest) {
    goal_id_ = std::max(utime, navigation_->goal_id + 1);
    ended_since_ = 0;
  }
}

bool Mission::is_bumped_after_end(std::int64_t utime) const {
  const auto seconds = [&](std::int64_t at) { return static_cast<double>(at - first_utime_) * 1e-6; };
  return ended_since_ != 0 &&
         std::any_of(scenario_.events.begin(), scenario_.events.end(), [&](const ScenarioEvent& event) {
           return event.kind == EventKind::kBump && event.at >= seconds(ended_since_) && event.at <= seconds(utime);
         });
}

void Mission::finish_goal(const sim_truth_t& truth, bool arrived) {
  const ScenarioGoal& wanted = goal(results_.size());
  GoalResult result;
  result.x = wanted.pose.x;
  result.y = wanted.pose.y;
  result.expect_refused = wanted.expect_refused;
  result.error_m = std::hypot(truth.x - wanted.pose.x, truth.y - wanted.pose.y);
  const double heading_error = wanted.has_theta ? std::abs(wrap_angle(truth.theta - wanted.pose.theta)) : 0.0;
  if (wanted.has_theta) {
    result.heading_error_deg = degrees(heading_error);
  }
  result.reached = arrived && result.error_m <= wanted.tolerance && heading_error <= kHeadingTolerance;
  result.refused = !arrived;
  result.time_s = static_cast<double>(ended_since_ - requested_at_) * 1e-6;
  result.cause = arrived && !result.reached
                     ? fmt::format("arrived {:.2f} m and {:.0f} deg off", result.error_m, degrees(heading_error))
                     : navigation_->cause;
  results_.push_back(result);
  goal_id_ = 0;
  ended_since_ = 0;
}

void Mission::on_robot_status(const robot_status_t& status) {
  if (scenario_.drives.empty() || !truth_ || truth_->utime - first_utime_ < kGoalDelay) {
    return;
  }
  if (drive_started_ == 0) {
    if (!status.motors_enabled) {
      return;
    }
    drive_started_ = truth_->utime;
    teleop_session_ = status.utime;
  }
  double at = static_cast<double>(truth_->utime - drive_started_) * 1e-6;
  for (const DriveStep& step : scenario_.drives) {
    if (at < step.duration) {
      teleop_command_t message{};
      message.utime = status.utime;
      message.session = teleop_session_;
      message.sequence = ++teleop_sequence_;
      message.linear = step.linear;
      message.angular = step.angular;
      lcm_.publish(channels::kTeleopCommand, &message);
      return;
    }
    at -= step.duration;
  }
}

std::vector<GoalResult> Mission::final_results() const {
  std::vector<GoalResult> all = results_;
  for (std::size_t i = all.size(); i < scenario_.goals.size() && !patrol_; ++i) {
    const ScenarioGoal& wanted = scenario_.goals[i];
    GoalResult missed;
    missed.x = wanted.pose.x;
    missed.y = wanted.pose.y;
    missed.expect_refused = wanted.expect_refused;
    if (truth_) {
      missed.error_m = std::hypot(truth_->x - wanted.pose.x, truth_->y - wanted.pose.y);
    }
    missed.cause = i == results_.size() && navigation_ && navigation_->goal_id == goal_id_
                       ? "out of time" + (navigation_->cause.empty() ? "" : ": " + navigation_->cause)
                       : "out of time";
    all.push_back(missed);
  }
  return all;
}

std::string Mission::failure() const {
  const std::vector<GoalResult> all = final_results();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool as_expected = goal(i).expect_refused ? all[i].refused : all[i].reached;
    if (!as_expected) {
      return fmt::format(
          "goal {} {}{}", i + 1,
          goal(i).expect_refused ? "was not refused" : (all[i].refused ? "was refused" : "was not reached"),
          all[i].cause.empty() ? "" : " (" + all[i].cause + ")");
    }
  }
  if (patrol_) {
    return all.empty() ? "no goal ended" : "";
  }
  return is_finished() || (scenario_.goals.empty() && scenario_.drives.empty()) ? "" : "out of time";
}

}  // namespace luminav
