#include "services/controller/controller.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

double seconds_between(std::int64_t from, std::int64_t to) {
  return 1e-6 * static_cast<double>(to - from);
}
std::int64_t microseconds(double seconds) {
  return static_cast<std::int64_t>(1e6 * seconds);
}

bool is_still(const DriveTwist& twist) {
  return std::abs(twist.linear) < 0.02 && std::abs(twist.angular) < 0.04;
}

}  // namespace

Controller::Controller(const ControllerConfig& config)
    : config_(config),
      stop_logic_(config.robot, config.stop_logic),
      follower_(config.follower, stop_logic_),
      wander_(config.wander, stop_logic_),
      progress_(config.progress),
      ramp_(config.robot.limits, config.jerk) {}

void Controller::forget_odometry() {
  wander_.clear();
  escape_.reset();
  standing_since_ = 0;
  task_ = ControlTask::kNone;
}

void Controller::enter(ControlTask task, const ControlInput& input) {
  if (task == ControlTask::kWander && task_ != ControlTask::kWander) {
    wander_.clear();
  }
  task_ = task;
  escape_.reset();
  escapes_ = 0;
  standing_since_ = 0;
  next_escape_ = 0;
  progress_.restart(input.now, input.odom_from_robot);
}

ControlOutput Controller::step(const ControlInput& input) {
  ControlOutput output;
  std::vector<ObstaclePoint> obstacles = input.echoes;
  if (input.world_from_robot && input.grid != nullptr) {
    const std::vector<ObstaclePoint> walls = known_walls(*input.grid, *input.world_from_robot, config_.local_map);
    obstacles.insert(obstacles.end(), walls.begin(), walls.end());
  }
  output.clearance = stop_logic_.clearance(obstacles);
  const ControlTask task = input.halt ? ControlTask::kNone : input.task;
  if (task != task_) {
    enter(task, input);
  }
  if (input.halt) {
    ramp_.restart_from({});
    output.state = ControlState::kStopped;
    output.reason = *input.halt;
    return output;
  }
  const DriveTwist wanted = wish(input, obstacles, output);
  const DriveTwist smooth = ramp_.step(wanted, input.duration);
  const StopVerdict verdict = stop_logic_.judge(smooth, obstacles, input.ages);
  ramp_.restart_from(verdict.twist);
  output.twist = verdict.twist;
  if (verdict.limited && (verdict.blocked || is_still(verdict.twist))) {
    output.reason = verdict.reason;
  }
  if (task == ControlTask::kFollow || task == ControlTask::kWander) {
    StopVerdict of_wish = verdict;
    of_wish.blocked = !is_still(wanted) && is_still(verdict.twist) && verdict.limited;
    wait_or_escape(input, of_wish, obstacles, output);
  }
  return output;
}

DriveTwist Controller::wish(const ControlInput& input, const std::vector<ObstaclePoint>& obstacles,
                            ControlOutput& output) {
  output.reason = input.task_reason;
  switch (input.task) {
    case ControlTask::kNone:
      return {};
    case ControlTask::kTeleop:
      output.state = ControlState::kTeleop;
      return input.teleoperation;
    case ControlTask::kWander:
      output.state = ControlState::kWandering;
      break;
    case ControlTask::kFollow:
      if (!input.world_from_robot) {
        output.state = ControlState::kStopped;
        return {};
      }
      follow(input, obstacles, output);
      if (output.follow.phase == FollowPhase::kAtGoal || output.follow.phase == FollowPhase::kNoPath) {
        escape_.reset();
        return {};
      }
      break;
  }
  if (escape_) {
    output.state = ControlState::kEscaping;
    output.reason = escape_->move.name;
    return escape_->move.twist;
  }
  if (input.task == ControlTask::kWander) {
    return wander_.step(input.now, input.odom_from_robot, obstacles);
  }
  return output.follow.wanted;
}

void Controller::follow(const ControlInput& input, const std::vector<ObstaclePoint>& obstacles, ControlOutput& output) {
  FollowSituation situation;
  situation.world_from_robot = *input.world_from_robot;
  situation.obstacles = obstacles;
  situation.may_back = input.ages.rear_sonar < config_.stop_logic.disc_silent_after;
  situation.duration = input.duration;
  situation.is_line_free = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    return input.grid == nullptr || is_line_free(*input.grid, from, to, config_.local_map);
  };
  output.follow = follower_.step(situation);
  switch (output.follow.phase) {
    case FollowPhase::kNoPath:
      output.state = ControlState::kIdle;
      output.reason = "there is no path to follow";
      break;
    case FollowPhase::kDriving:
      output.state = ControlState::kFollowing;
      break;
    case FollowPhase::kTurning:
      output.state = ControlState::kTurning;
      break;
    case FollowPhase::kAtGoal:
      output.state = ControlState::kAtGoal;
      break;
  }
}

void Controller::wait_or_escape(const ControlInput& input, const StopVerdict& verdict,
                                const std::vector<ObstaclePoint>& obstacles, ControlOutput& output) {
  const bool has_work = output.state != ControlState::kAtGoal && output.state != ControlState::kIdle &&
                        output.state != ControlState::kStopped;
  if (!has_work) {
    progress_.restart(input.now, input.odom_from_robot);
    standing_since_ = 0;
    escapes_ = 0;
    return;
  }
  const double stuck_for = progress_.update(input.now, input.odom_from_robot);
  output.seconds_without_progress = stuck_for;
  if (stuck_for < 0.5 && !escape_) {
    escapes_ = 0;
  }
  if (escape_ && (verdict.blocked || input.now >= escape_->until)) {
    escape_.reset();
    standing_since_ = 0;
    next_escape_ = input.now + microseconds(config_.escape_pause);
  }
  if (escape_) {
    return;
  }
  if (!verdict.blocked) {
    standing_since_ = 0;
  } else if (standing_since_ == 0) {
    standing_since_ = input.now;
  }
  const double standing = standing_since_ == 0 ? 0.0 : seconds_between(standing_since_, input.now);
  const bool waits_for_people = verdict.by_unknown && input.task == ControlTask::kFollow;
  if (verdict.blocked && waits_for_people) {
    output.state = ControlState::kYielding;
  }
  if (standing > config_.settle_after && input.task == ControlTask::kFollow && input.world_from_robot &&
      follower_.is_within_tolerance(*input.world_from_robot)) {
    follower_.settle();
  }
  const double patience = waits_for_people ? config_.patience : config_.patience_with_walls;
  const bool is_spinning = stuck_for > config_.stuck_after;
  if ((standing > patience || is_spinning) && input.now >= next_escape_) {
    if (input.task == ControlTask::kWander) {
      wander_.give_up(input.now, input.odom_from_robot);
    }
    const bool may_back = input.ages.rear_sonar < config_.stop_logic.disc_silent_after;
    const double aim = output.follow.heading_error;
    if (const auto move = choose_escape(escapes_, aim, may_back, obstacles, stop_logic_)) {
      escape_ = Escape{*move, input.now + microseconds(move->duration)};
      output.state = ControlState::kEscaping;
      output.reason = move->name;
    }
    ++escapes_;
    next_escape_ = input.now + microseconds(config_.escape_pause);
  }
  if (!escape_ && stuck_for > config_.stuck_after) {
    output.state = ControlState::kStuck;
    if (output.reason.empty()) {
      output.reason = "the way ahead leads nowhere";
    }
  }
}

}  // namespace luminav
