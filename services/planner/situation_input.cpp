#include "services/planner/situation_input.hpp"

#include "services/common/geometry/seconds.hpp"
#include "services/common/process/lcm_conversions.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {
namespace {

constexpr double kPoseAge = 1.0;                 // [s] an older pose does not count
constexpr double kControlAge = 2.0;              // [s] a controller silent for longer does not count
constexpr std::int64_t kPoseMissing = 150'000;   // [us]
constexpr std::int64_t kOtherClock = 1'000'000;  // [us] no two stamps of one clock are so far apart

const char* reason_not_to_move(const robot_status_t& robot) {
  return !robot.connected        ? "the robot does not answer"
         : robot.stop_engaged    ? "a stop is engaged"
         : robot.stop_button     ? "the button on the robot is pressed"
         : !robot.motors_enabled ? "the motors are off"
                                 : "";
}

}  // namespace

SituationInput::Verdict SituationInput::take(const pose_t& message) {
  if (pose_ && message.utime == pose_->utime) {
    pose_ = message;  // corrected by a picture, no new tick
    return {};
  }
  const StampGuard::Verdict verdict = pose_stamps_.check(message.utime);
  if (verdict == StampGuard::Verdict::kOld) {
    return {.is_refused = true};
  }
  pose_ = message;
  return {.is_new_session = verdict == StampGuard::Verdict::kNewSession, .is_tick = true};
}

SituationInput::Verdict SituationInput::take(const robot_status_t& message) {
  const StampGuard::Verdict verdict = robot_stamps_.check(message.utime);
  if (message.utime <= 0 || verdict == StampGuard::Verdict::kOld) {
    return {.is_refused = true};
  }
  // kept until the next tick: a touch may be over by then, and the controller about to leave
  const bool begins = is_blocked(message) && !(robot_ && is_blocked(*robot_));
  const bool follows = control_ && control_->state == control_status_t::STATE_FOLLOWING;
  has_touched_ = has_touched_ || (begins && follows);
  robot_ = message;
  const bool is_tick =
      !pose_ || message.utime - pose_->utime > kPoseMissing || message.utime < pose_->utime - kOtherClock;
  return {.is_new_session = verdict == StampGuard::Verdict::kNewSession, .is_tick = is_tick};
}

void SituationInput::take(const control_status_t& message, std::int64_t now) {
  if (!all_finite({message.seconds_without_progress}) ||
      control_stamps_.check(message.utime) == StampGuard::Verdict::kOld) {
    // the controller answers ODOMETRY and ROBOT_STATUS, two of its words may carry one stamp
    if (control_ && message.utime == control_->utime && message.sequence > control_->sequence) {
      control_ = message;
    }
    return;
  }
  control_ = message;
  control_heard_ = now;
}

void SituationInput::begin_tick(std::int64_t now) {
  if (control_heard_ > now || control_heard_ == 0) {
    control_heard_ = now;
  }
}

Situation SituationInput::at(std::int64_t now) const {
  Situation moment;
  moment.now = now;
  moment.has_touched = has_touched_;
  if (!pose_ || seconds_between(pose_->utime, now) > kPoseAge || pose_->utime - now > kOtherClock) {
    moment.localization = "no pose from the localizer for more than a second";
  } else {
    moment.tracking = pose_->state == pose_t::STATE_TRACKING;
    moment.world_from_robot = world_from_robot(*pose_);
    moment.localization = pose_->reason;
  }
  if (robot_) {
    moment.cannot_move = reason_not_to_move(*robot_);
    moment.can_move = moment.cannot_move.empty();
  }
  if (control_ && seconds_between(control_heard_, now) <= kControlAge) {
    if (control_->stop_engaged && moment.can_move) {
      moment.can_move = false;
      moment.cannot_move = "a stop is engaged";
    }
    moment.control = control_report();
  }
  return moment;
}

ControlReport SituationInput::control_report() const {
  ControlReport report;
  report.at_goal = control_->state == control_status_t::STATE_AT_GOAL;
  report.yielding = control_->state == control_status_t::STATE_YIELDING;
  report.stuck = control_->state == control_status_t::STATE_STUCK;
  report.follows = control_->state == control_status_t::STATE_FOLLOWING;
  report.path_sequence = control_->path_sequence;
  report.seconds_without_progress = control_->seconds_without_progress;
  report.reason = control_->reason;
  return report;
}

}  // namespace luminav
