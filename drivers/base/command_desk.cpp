#include "drivers/base/command_desk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kStatusPeriod = 20'000;   // [us] 50 Hz
constexpr std::int64_t kGuardianPause = 50'000;  // [us] least, after the guardian is done with the line
constexpr std::int64_t kLongestGap = 250'000;    // [us] the process slept: what waits is outdated

}  // namespace

CommandDesk::CommandDesk(lcm::LCM& lcm, const BaseConfig& config, const Clock& clock, std::optional<CommandKey> key,
                         CommandedBase& base)
    : robot_(config.robot.name),
      supervised_(config.supervised),
      clock_(clock),
      base_(base),
      gate_({config.command_timeout, config.robot.limits.linear, config.robot.limits.angular}),
      stop_(config.state_folder),
      life_(config.guardian_silence, config.guardian_done_after),
      watched_(clock.utime()),
      deceleration_(config.robot.limits.linear_deceleration),
      subscriber_(lcm, key) {
  subscriber_.on(channels::kVelocityCommand, &CommandDesk::on_velocity_command, this);
  subscriber_.on(channels::kStop, &CommandDesk::on_stop, this);
  subscriber_.on(channels::kSupervision, &CommandDesk::on_supervision, this);
  subscriber_.on(channels::kMotorsCommand, &CommandDesk::on_motors_command, this);
}

void CommandDesk::on_velocity_command(const velocity_command_t& message) {
  const std::int64_t now = wake();
  if (message.robot != robot_) {
    subscriber_.drop("VELOCITY_COMMAND: meant for another robot");
    return;
  }
  const std::string why = gate_.offer({.utime = message.utime,
                                       .session = message.session,
                                       .sequence = message.sequence,
                                       .linear = message.linear_x,
                                       .sideways = message.linear_y,
                                       .angular = message.angular_z},
                                      now);
  if (!why.empty()) {
    subscriber_.drop("VELOCITY_COMMAND: " + why);
    return;
  }
  if ((message.linear_x != 0.0 || message.angular_z != 0.0) && is_unsupervised(now)) {
    obey_stop(now, now, true, fmt::format("the driver: no page and no operator for {:.0f} s", supervised_));
    return;
  }
  base_.follow(now);
}

void CommandDesk::on_stop(const stop_t& message) {
  obey_stop(wake(), message.id, message.engaged != 0, message.sender);
}

void CommandDesk::obey_stop(std::int64_t now, std::int64_t id, bool engaged, const std::string& sender) {
  if (stop_.request(id, engaged, sender)) {
    gate_.clear(now);
    base_.follow_stop(now);
  }
  stop_.save(now);
}

void CommandDesk::on_supervision(const supervision_t&) {
  watched_ = clock_.utime();
}

// Asked when a command would move the robot: one that stands needs nobody, and nobody comes back to a robot that
// drives.
bool CommandDesk::is_unsupervised(std::int64_t now) const {
  return supervised_ > 0.0 && 1e-6 * static_cast<double>(now - watched_) > supervised_;
}

void CommandDesk::on_motors_command(const motors_command_t& message) {
  // Each request is repeated by its sender; a late copy of an older one, or a recording, must not undo the newest.
  if (message.id <= last_motors_command_) {
    return;
  }
  last_motors_command_ = message.id;
  const std::int64_t now = wake();
  gate_.clear(now);
  base_.switch_motors(now, message.enable != 0);
}

std::int64_t CommandDesk::wake() {
  const std::int64_t now = clock_.utime();
  const bool slept = last_wake_ != 0 && now - last_wake_ > kLongestGap;
  const bool guardian_acted = life_.guardian_may_have_acted(now);
  last_wake_ = now;
  if (slept || guardian_acted) {
    // The guardian or the robot's watchdog has stopped the robot by now, and the first packet would resume its motion.
    gate_.clear(now);
    base_.stand_after_gap(now);
  }
  if (guardian_acted) {
    // Waiting until the robot's silence tells would take seconds; meanwhile the guardian still uses the line.
    base_.begin_anew(now, std::max(kGuardianPause, life_.guardian_done_at() - now));
    life_.forget();
  }
  return now;
}

void CommandDesk::finish_poll(std::int64_t now) {
  stop_.save(now);
  life_.beat(clock_);
}

bool CommandDesk::hold(const std::string& why) {
  const bool begins = !why.empty() && held_because_.empty();
  held_because_ = why;
  return begins;
}

bool CommandDesk::stand_for_good(const DriveVelocity& measured) {
  standing_still_ = true;
  constexpr double kStanding = 0.02;  // [m/s] and [rad/s]
  return std::abs(measured.linear) < kStanding && std::abs(measured.angular) < kStanding;
}

DriveVelocity CommandDesk::wanted(std::int64_t now) const {
  const bool stands = stop_.engaged() || standing_still_ || !held_because_.empty();
  return stands ? DriveVelocity{} : gate_.velocity(now);
}

std::string CommandDesk::reason(std::int64_t now, const std::string& hazard, bool stall_left, bool stall_right) const {
  if (stop_.engaged()) {
    return "stop requested by " + (stop_.sender().empty() ? "somebody" : stop_.sender());
  }
  if (!held_because_.empty()) {
    return held_because_;
  }
  if (!hazard.empty()) {
    return hazard;
  }
  if (stall_left || stall_right) {
    return stall_left && stall_right ? "both wheels are blocked"
           : stall_left              ? "the left wheel is blocked"
                                     : "the right wheel is blocked";
  }
  return gate_.is_fresh(now) ? "" : "no fresh command";
}

std::optional<robot_status_t> CommandDesk::due_status(std::int64_t now, bool may_move) {
  if (now < next_status_) {
    return std::nullopt;
  }
  next_status_ = now - next_status_ > 5 * kStatusPeriod ? now + kStatusPeriod : next_status_ + kStatusPeriod;
  robot_status_t message{};
  message.utime = now;
  message.robot = robot_;
  message.sequence = status_sequence_++;
  message.stop_engaged = stop_.engaged() ? 1 : 0;
  message.command_fresh = may_move && !stop_.engaged() && gate_.is_fresh(now) ? 1 : 0;
  message.charge_state = robot_status_t::CHARGE_UNKNOWN;
  message.maximum_linear = gate_.params().maximum_linear;
  message.maximum_angular = gate_.params().maximum_angular;
  message.deceleration = deceleration_;
  message.stop_id = stop_.id();
  message.motors_command_id = last_motors_command_;
  message.commands_refused = gate_.refused();
  return message;
}

}  // namespace luminav
