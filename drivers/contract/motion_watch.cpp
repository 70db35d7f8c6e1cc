#include "drivers/contract/motion_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kStandingLinear = 0.03;   // [m/s] encoders of small bases are coarse
constexpr double kStandingAngular = 0.05;  // [rad/s]
constexpr double kSlack = 0.25;            // [s] from a command to the wheels, and from the wheels to ODOMETRY
constexpr double kSettled = 1.0;           // [s] of the same command: the wheels have its speed
constexpr double kEchoed = 0.15;           // [s] ROBOT_STATUS knows of a command
constexpr double kMotorsReady = 1.0;       // [s] after they came on
constexpr double kObeyed = 0.5;            // of the speed that was asked for
constexpr double kFaster = 1.1;            // of a limit: overshoot of the base's own speed loop
constexpr double kSpeedOver = 0.5;         // [s] speeds are averaged: one alone has the jitter of the stamps it is from

bool is_engaged(std::int64_t since) {
  return since != 0;
}

}  // namespace

MotionWatch::MotionWatch(const RobotDescription& robot) : limits_(robot.limits) {}

double MotionWatch::braking_time(double linear, double angular) const {
  return std::max(std::abs(linear) / limits_.linear_deceleration, std::abs(angular) / limits_.angular_acceleration);
}

double MotionWatch::time_to_brake() const {
  const CommandLedger::Command& told = ledger_.last();
  const double linear = std::min(std::abs(told.linear), limits_.linear);
  const double angular = std::min(std::abs(told.angular), limits_.angular);
  return std::max(braking_time(odometry_.linear, odometry_.angular), braking_time(linear, angular));
}

double MotionWatch::age(std::int64_t since, std::int64_t now) const {
  return 1e-6 * static_cast<double>(now - since);
}

void MotionWatch::hear(const velocity_command_t& message) {
  if (!status_) {
    return;
  }
  const std::int64_t refusable = ledger_.refusable();
  const std::string why = ledger_.hear(message, status_->robot, status_->utime);
  if (why.empty() && !is_engaged(stopped_since_)) {
    brake_ = time_to_brake();
  }
  if (ledger_.refusable() > refusable && unsound_since_ == 0) {
    unsound_since_ = status_->utime;
    refused_before_ = status_->commands_refused;
  }
}

void MotionWatch::hear(const stop_t& message) {
  if (!status_) {
    return;
  }
  if (message.engaged && !is_engaged(stopped_since_)) {
    stopped_since_ = status_->utime;
    brake_ = time_to_brake();
  } else if (!message.engaged && is_engaged(stopped_since_)) {
    stopped_since_ = 0;
    released_at_ = status_->utime;
  }
}

void MotionWatch::hear(const robot_status_t& message) {
  if (!status_ || status_->motors_enabled != message.motors_enabled) {
    motors_since_ = message.utime;
  }
  began_ = status_ ? began_ : message.utime;
  status_ = message;
  judge_refusals(message);
  const CommandLedger::Command& told = ledger_.last();
  const bool may_obey = message.connected && message.motors_enabled &&
                        age(std::max(motors_since_, released_at_), message.utime) > kMotorsReady;
  const bool is_steady = told.utime != 0 && age(ledger_.steady_since(), message.utime) > kEchoed;
  const bool stops = is_engaged(stopped_since_) && age(stopped_since_, message.utime) > kEchoed;
  if (stops || age(told.utime, message.utime) > CommandLedger::kTimeout + kEchoed) {
    clauses_.fresh.require(!message.command_fresh, stops
                                                       ? "command_fresh while a STOP is in force"
                                                       : "command_fresh, and none was sent that is younger than 0.3 s");
  } else if (may_obey && is_steady && !is_engaged(stopped_since_) && age(told.utime, message.utime) < kEchoed) {
    clauses_.fresh.require(message.command_fresh, "not command_fresh, though fresh ones are sent");
  }
}

void MotionWatch::judge_refusals(const robot_status_t& message) {
  constexpr double kCounted = 0.3;  // [s]
  if (unsound_since_ != 0 && age(unsound_since_, message.utime) > kCounted) {
    clauses_.refused.judge(message.commands_refused > refused_before_,
                           fmt::format("{} before, {} after", refused_before_, message.commands_refused));
    unsound_since_ = 0;
  }
}

void MotionWatch::hear(const odometry_t& message) {
  odometry_ = message;
  if (!status_) {
    return;
  }
  const bool moves = std::abs(message.linear) > kStandingLinear || std::abs(message.angular) > kStandingAngular;
  if (!status_->motors_enabled) {
    const bool is_told = ledger_.last().moves() && age(ledger_.last().utime, message.utime) < CommandLedger::kTimeout;
    const double coasting = braking_time(limits_.linear, limits_.angular) + kSlack;
    if (is_told && age(motors_since_, message.utime) > coasting) {
      clauses_.unpowered.judge(!moves, fmt::format("{:.2f} m/s, {:.2f} rad/s", message.linear, message.angular));
    }
    speeds_ = {};
    return;  // somebody may push it
  }
  judge_limits(message);
  judge_standing(message, moves);
  judge_moving(message);
}

void MotionWatch::judge_limits(const odometry_t& message) {
  speeds_.since = speeds_.count == 0 ? message.utime : speeds_.since;
  speeds_.linear += message.linear;
  speeds_.angular += message.angular;
  ++speeds_.count;
  if (age(speeds_.since, message.utime) < kSpeedOver) {
    return;
  }
  const double linear = speeds_.linear / speeds_.count;
  const double angular = speeds_.angular / speeds_.count;
  const bool is_within = std::abs(linear) <= kFaster * status_->maximum_linear + kStandingLinear &&
                         std::abs(angular) <= kFaster * status_->maximum_angular + kStandingAngular;
  clauses_.limits.judge(is_within, fmt::format("{:.2f} m/s, {:.2f} rad/s of {:.2f} and {:.2f}", linear, angular,
                                               status_->maximum_linear, status_->maximum_angular));
  speeds_ = {};
}

void MotionWatch::judge_standing(const odometry_t& message, bool moves) {
  const std::string seen = fmt::format("{:.2f} m/s, {:.2f} rad/s", message.linear, message.angular);
  if (is_engaged(stopped_since_)) {
    if (age(stopped_since_, message.utime) > brake_ + kSlack) {
      clauses_.stop.judge(!moves, fmt::format("{} {:.1f} s after it", seen, age(stopped_since_, message.utime)));
    }
    return;
  }
  const CommandLedger::Command& told = ledger_.last();
  const std::int64_t since = told.utime != 0 ? told.utime : began_;
  const double brake = told.utime != 0 ? brake_ : braking_time(limits_.linear, limits_.angular);
  const double allowed = (told.moves() || told.utime == 0 ? CommandLedger::kTimeout : 0.0) + brake + kSlack;
  if (age(since, message.utime) > allowed) {
    clauses_.stands.judge(!moves, fmt::format("{} {:.1f} s after the last", seen, age(since, message.utime)));
  }
}

void MotionWatch::judge_moving(const odometry_t& message) {
  const CommandLedger::Command& told = ledger_.last();
  const bool is_hindered = status_->stall_left || status_->stall_right || status_->stop_button ||
                           status_->bumpers_front != 0 || status_->bumpers_rear != 0 || is_engaged(stopped_since_);
  const bool is_ready = age(std::max(motors_since_, released_at_), message.utime) > kMotorsReady;
  if (!told.moves() || is_hindered || !is_ready || age(told.utime, message.utime) > CommandLedger::kTimeout ||
      age(ledger_.steady_since(), message.utime) < kSettled + braking_time(told.linear, told.angular)) {
    return;
  }
  const bool turns = std::abs(told.angular) > std::abs(told.linear);
  const double asked = turns ? std::clamp(told.angular, -status_->maximum_angular, status_->maximum_angular)
                             : std::clamp(told.linear, -status_->maximum_linear, status_->maximum_linear);
  const double share = (turns ? message.angular : message.linear) / asked;
  clauses_.moves.judge(share >= kObeyed, fmt::format("{:.0f} % of the speed asked for", 100.0 * share));
}

std::vector<Clause> MotionWatch::clauses() const {
  return {clauses_.moves, clauses_.stands,  clauses_.unpowered, clauses_.limits,
          clauses_.fresh, clauses_.refused, clauses_.stop};
}

}  // namespace luminav
