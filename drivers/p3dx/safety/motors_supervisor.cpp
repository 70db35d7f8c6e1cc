#include "drivers/p3dx/safety/motors_supervisor.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kRepeat = 1'000'000;  // [us]
constexpr int kConfirmations = 2;

}  // namespace

void MotorsSupervisor::on_connected() {
  seen_on_ = false;
  seen_off_ = false;
  off_count_ = 0;
  on_count_ = 0;
  attempts_ = 0;
  last_sent_ = 0;
}

void MotorsSupervisor::request(bool enable) {
  wish_ = enable;
  on_connected();
  button_ = false;
  reason_ = enable ? "waiting for the motors to come on" : "motors were switched off by request";
}

std::optional<bool> MotorsSupervisor::send(bool enable, std::int64_t now) {
  if (last_sent_ != 0 && now - last_sent_ < kRepeat) {
    return std::nullopt;
  }
  last_sent_ = now;
  ++attempts_;
  return enable;
}

std::optional<bool> MotorsSupervisor::update(const InformationPacket& packet, std::int64_t now) {
  off_count_ = packet.motors_enabled ? 0 : off_count_ + 1;
  on_count_ = packet.motors_enabled ? on_count_ + 1 : 0;
  if (packet.stop_button) {
    button_ = true;
    wish_ = false;
    reason_ = "the stop button on the robot is pressed";
    return std::nullopt;
  }
  if (button_) {
    reason_ = "the stop button on the robot was pressed: enable the motors again";
  }
  if (on_count_ >= kConfirmations) {
    if (wish_) {
      seen_on_ = true;
      button_ = false;
      reason_.clear();
      attempts_ = 0;
      return std::nullopt;
    }
    if (seen_off_) {
      request(true);  // somebody pressed the motors button on the robot
      return std::nullopt;
    }
    reason_ = "motors are on at the robot and not wanted";
    return send(false, now);
  }
  if (off_count_ < kConfirmations) {
    return std::nullopt;
  }
  if (!wish_) {
    seen_off_ = true;
    if (reason_.empty()) {
      reason_ = "motors are off until they are requested";
    }
    return std::nullopt;
  }
  if (seen_on_) {
    wish_ = false;
    seen_off_ = true;
    reason_ = "motors were switched off at the robot: enable them again";
    return std::nullopt;
  }
  reason_ = attempts_ < 3 ? "waiting for the motors to come on"
                          : "the robot does not switch its motors on (asked " + std::to_string(attempts_) + " times)";
  return send(true, now);
}

}  // namespace luminav
