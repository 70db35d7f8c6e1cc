#include "services/controller/following/speed_law.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kFullError = radians(12.0);  // [rad] heading error that does not slow it down
constexpr double kStopError = radians(60.0);  // [rad] heading error at which it only turns
constexpr double kNarrow = 0.06;              // [m] clearance at which it creeps
constexpr double kCreep = 0.35;               // share of the speed left where it is narrow
constexpr double kApproachGain = 0.8;         // [1/s] speed per distance left to the goal
constexpr double kSlowest = 0.03;             // [m/s] towards the goal

}  // namespace

DriveTwist speed_law(double heading_error, double clearance, double distance_left, const SpeedLawParams& params) {
  const double error = std::abs(heading_error);
  const double by_error = std::clamp((kStopError - error) / (kStopError - kFullError), 0.0, 1.0);
  const double openness = std::clamp((clearance - kNarrow) / (params.wide - kNarrow), 0.0, 1.0);
  const double by_clearance = kCreep + (1.0 - kCreep) * openness;
  const double by_distance = std::max(kSlowest, kApproachGain * distance_left);
  DriveTwist twist;
  twist.linear = std::min(params.linear * by_clearance, by_distance) * by_error;
  twist.angular = std::clamp(params.turn_gain * heading_error, -params.angular, params.angular);
  return twist;
}

DriveTwist CommandRamp::step(const DriveTwist& wanted, double duration) {
  current_before_ = current_;
  acceleration_before_ = acceleration_;
  duration_ = duration;
  const double change = wanted.linear - current_.linear;
  const bool speeds_up = std::abs(wanted.linear) > std::abs(current_.linear) && wanted.linear * current_.linear >= 0.0;
  if (speeds_up) {
    acceleration_ = std::min(acceleration_ + jerk_ * duration, limits_.linear_acceleration);
    // ease out as well: no more than what a constant jerk can still take back
    const double max = std::min(acceleration_, std::sqrt(2.0 * jerk_ * std::abs(change)));
    current_.linear += std::clamp(change, -max * duration, max * duration);
  } else {
    acceleration_ = 0.0;
    const double max = limits_.linear_deceleration * duration;
    // through zero only in a step of its own
    const double target = wanted.linear * current_.linear < 0.0 ? 0.0 : wanted.linear;
    current_.linear += std::clamp(target - current_.linear, -max, max);
  }
  const double max_turn = limits_.angular_acceleration * duration;
  current_.angular += std::clamp(wanted.angular - current_.angular, -max_turn, max_turn);
  return current_;
}

DriveTwist CommandRamp::step_again(const DriveTwist& wanted) {
  current_ = current_before_;
  acceleration_ = acceleration_before_;
  return step(wanted, duration_);
}

void CommandRamp::stop() {
  current_ = current_before_ = {};
  acceleration_ = acceleration_before_ = 0.0;
}

void CommandRamp::restart_from(const DriveTwist& driven) {
  if (std::abs(driven.linear) < std::abs(current_.linear)) {
    acceleration_ = 0.0;
  }
  current_ = driven;
}

}  // namespace luminav
