#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/create2/hazard_watch.hpp"

namespace luminav {

/// Compares the wish for motors with the robot's mode: safe has motors, passive has none. The robot itself leaves safe
/// mode at a cliff, to which it is brought back so that it can back off, and with a wheel in the air or by its button,
/// where a fresh request is needed.
class PowerSupervisor {
 public:
  explicit PowerSupervisor(bool enable_at_start) : wish_(enable_at_start) {}

  void on_connected();
  void request(bool enable);
  /// To be called with each reading: the mode to ask for now, if any.
  std::optional<OiOpcode> update(const SensorReading& reading, const HazardWatch& hazards, std::int64_t now);

  /// Why the motors are off, one sentence; "" when they are on.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  [[nodiscard]] bool wish() const { return wish_; }
  [[nodiscard]] static bool has_motors(const SensorReading& reading) {
    return reading.mode == OiMode::kSafe || reading.mode == OiMode::kFull;
  }

 private:
  std::optional<OiOpcode> ask(OiOpcode mode, std::int64_t period, std::int64_t now);

  bool wish_;
  bool seen_on_ = false;         // since the last request or connection
  std::int64_t cliff_at_ = 0;    // [us] seen last
  std::int64_t last_asked_ = 0;  // [us] 0 = may ask now
  std::string reason_ = "waiting for the motors to come on";
};

}  // namespace luminav
