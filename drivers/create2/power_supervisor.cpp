#include "drivers/create2/power_supervisor.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kRepeat = 1'000'000;     // [us]
constexpr std::int64_t kAtCliff = 50'000;       // [us]
constexpr std::int64_t kCliffMemory = 500'000;  // [us] in which leaving safe mode was because of it

}  // namespace

void PowerSupervisor::on_connected() {
  seen_on_ = false;
  last_asked_ = 0;
}

void PowerSupervisor::request(bool enable) {
  wish_ = enable;
  on_connected();
  reason_ = enable ? "waiting for the motors to come on" : "motors were switched off by request";
}

std::optional<OiOpcode> PowerSupervisor::ask(OiOpcode mode, std::int64_t period, std::int64_t now) {
  if (last_asked_ != 0 && now - last_asked_ < period) {
    return std::nullopt;
  }
  last_asked_ = now;
  return mode;
}

std::optional<OiOpcode> PowerSupervisor::update(const SensorReading& reading, const HazardWatch& hazards,
                                                std::int64_t now) {
  cliff_at_ = hazards.sees_cliff() ? now : cliff_at_;
  if (hazards.is_lifted() && wish_) {
    wish_ = false;
    last_asked_ = 0;
    reason_ = "a wheel hung in the air: put the robot down and enable the motors again";
  }
  if (has_motors(reading)) {
    if (!wish_) {
      return ask(OiOpcode::kStart, kRepeat, now);
    }
    seen_on_ = true;
    reason_.clear();
    return std::nullopt;
  }
  if (!wish_) {
    reason_ = reason_.empty() ? "motors are off until they are requested" : reason_;
    return std::nullopt;
  }
  if (cliff_at_ != 0 && now - cliff_at_ < kCliffMemory) {
    reason_ = hazards.reason();
    return ask(OiOpcode::kSafe, kAtCliff, now);
  }
  if (reading.charging_state >= 1 && reading.charging_state <= 4) {
    reason_ = "it stands on its charger";
    return std::nullopt;
  }
  if (seen_on_) {
    wish_ = false;
    reason_ = "motors were switched off at the robot: enable them again";
    return std::nullopt;
  }
  reason_ = "waiting for the motors to come on";
  return ask(OiOpcode::kSafe, kRepeat, now);
}

}  // namespace luminav
