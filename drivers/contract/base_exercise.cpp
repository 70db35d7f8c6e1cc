#include "drivers/contract/base_exercise.hpp"

#include <algorithm>
#include <array>
#include <luminav/motors_command_t.hpp>
#include <luminav/stop_t.hpp>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

enum class Sends { kNothing, kFresh, kOld, kRepeated, kForeign, kSideways };
enum class Asks { kNothing, kStop, kRelease, kMotorsOff, kMotorsOn };

struct Phase {
  const char* doing;
  double duration;  // [s]
  Sends sends = Sends::kNothing;
  double linear = 0.0;   // [m/s]
  double angular = 0.0;  // [rad/s]
  Asks asks = Asks::kNothing;
};

constexpr double kTurn = 0.4;      // [rad/s]
constexpr double kCreep = 0.1;     // [m/s]
constexpr double kTooFast = 20.0;  // [rad/s] nobody's limit

constexpr std::array kPhases = {
    Phase{"listening", 2.0},
    Phase{"turning", 2.0, Sends::kFresh, 0.0, kTurn},
    Phase{"silent", 2.0},
    Phase{"creeping ahead", 2.0, Sends::kFresh, kCreep, 0.0},
    Phase{"creeping back", 2.0, Sends::kFresh, -kCreep, 0.0},
    Phase{"commanding to stand", 1.5, Sends::kFresh},
    // a driver may forget a sender that was not obeyed for a second: shorter
    Phase{"repeating one sequence", 0.7, Sends::kRepeated, 0.0, kTurn},
    Phase{"silent", 1.0},
    Phase{"answering old messages", 1.0, Sends::kOld, 0.0, kTurn},
    Phase{"commanding another robot", 1.0, Sends::kForeign, 0.0, kTurn},
    Phase{"commanding sideways", 1.0, Sends::kSideways},
    Phase{"turning as fast as it may", 3.0, Sends::kFresh, 0.0, kTooFast},
    Phase{"stopping it", 2.0, Sends::kFresh, 0.0, kTurn, Asks::kStop},
    Phase{"releasing it", 1.5, Sends::kNothing, 0.0, 0.0, Asks::kRelease},
    Phase{"turning back", 2.5, Sends::kFresh, 0.0, -kTurn},
    Phase{"switching its motors off", 4.0, Sends::kFresh, 0.0, kTurn, Asks::kMotorsOff},
    Phase{"stopping it", 1.0, Sends::kNothing, 0.0, 0.0, Asks::kStop},
    Phase{"releasing it", 2.5, Sends::kNothing, 0.0, 0.0, Asks::kRelease},
    Phase{"switching its motors on", 4.0, Sends::kNothing, 0.0, 0.0, Asks::kMotorsOn},
    Phase{"turning", 2.5, Sends::kFresh, 0.0, -kTurn},
    Phase{"silent", 1.5},
};

std::string objection_to(const robot_status_t& status) {
  if (!status.connected) {
    return "the base is not connected: " + status.reason;
  }
  if (status.stop_engaged || status.stop_button) {
    return "a stop is in force: release it first";
  }
  return status.motors_enabled ? "" : "the motors are off: switch them on first";
}

}  // namespace

BaseExercise::BaseExercise(lcm::LCM& lcm, const std::string& robot, std::optional<CommandKey> key)
    : commands_(lcm, key), robot_(robot) {}

bool BaseExercise::is_done() const {
  return phase_ >= kPhases.size() || !refusal_.empty();
}

std::string BaseExercise::doing() const {
  return is_done() ? "done" : kPhases[phase_].doing;
}

void BaseExercise::hear(const velocity_command_t& message) {
  if (message.session != session_ && message.robot == robot_ && refusal_.empty()) {
    refusal_ = "another process commands this robot: end its controller first";
  }
}

void BaseExercise::hear(const robot_status_t& message) {
  if (is_done() || message.robot != robot_) {
    return;
  }
  if (phase_began_ == 0) {
    begin_phase(message);
  }
  const double passed = 1e-6 * static_cast<double>(message.utime - phase_began_);
  if (passed > kPhases[phase_].duration || passed < 0.0) {
    ++phase_;
    if (is_done()) {
      return;
    }
    begin_phase(message);
  }
  if (phase_ == 1 && sequence_ == 0) {
    refusal_ = objection_to(message);
    if (is_done()) {
      return;
    }
  }
  request(message);
  command(message);
}

void BaseExercise::begin_phase(const robot_status_t& message) {
  phase_began_ = message.utime;
  last_request_ = 0;
  request_id_ = std::max(message.utime, request_id_ + 1);
  session_ = session_ == 0 ? message.utime : session_;
}

void BaseExercise::request(const robot_status_t& message) {
  const Asks asks = kPhases[phase_].asks;
  constexpr std::int64_t kRepeat = 200'000;  // [us]
  const bool is_about_stop = asks == Asks::kStop || asks == Asks::kRelease;
  const std::int64_t echoed = is_about_stop ? message.stop_id : message.motors_command_id;
  if (asks == Asks::kNothing || echoed >= request_id_ || message.utime - last_request_ < kRepeat) {
    return;
  }
  last_request_ = message.utime;
  if (is_about_stop) {
    stop_t stop{};
    stop.utime = stop.id = request_id_;
    stop.engaged = asks == Asks::kStop ? 1 : 0;
    stop.sender = "check-base";
    commands_.publish(channels::kStop, stop);
  } else {
    motors_command_t motors{};
    motors.utime = motors.id = request_id_;
    motors.enable = asks == Asks::kMotorsOn ? 1 : 0;
    commands_.publish(channels::kMotorsCommand, motors);
  }
}

void BaseExercise::command(const robot_status_t& message) {
  const Phase& phase = kPhases[phase_];
  if (phase.sends == Sends::kNothing) {
    return;
  }
  constexpr std::int64_t kOutdated = 700'000;  // [us]
  velocity_command_t command{};
  command.utime = message.utime - (phase.sends == Sends::kOld ? kOutdated : 0);
  command.robot = phase.sends == Sends::kForeign ? robot_ + "-other" : robot_;
  command.session = session_;
  command.sequence = phase.sends == Sends::kRepeated ? sequence_ : ++sequence_;
  command.linear_x = phase.linear;
  command.linear_y = phase.sends == Sends::kSideways ? kCreep : 0.0;
  command.angular_z = phase.angular;
  commands_.publish(channels::kVelocityCommand, command);
}

}  // namespace luminav
