#pragma once

#include <optional>

namespace luminav {

struct BatteryParams {
  double low = 11.7;         // [V] below this it drives home
  double per_metre = 0.003;  // [V] that the limit rises with each metre to home
  double enough = 12.5;      // [V] above this it takes jobs again
  double average = 20.0;     // [s] time constant of the voltage: it sags whenever the motors pull
  double charging = 12.8;    // [V] a charger that is connected holds it above this
};

/// What the robot says of its charger.
enum class Charger { kNotHeard, kCharges, kHasCharged };

/// When to drive home, by voltage: with hysteresis, so that a battery that recovers while the robot stands does not
/// send it out again. A charger lifts the voltage at once, so that one that is heard has the word itself.
class BatteryWatch {
 public:
  explicit BatteryWatch(const BatteryParams& params) : params_(params) {}

  /// `voltage` [V], 0 = unknown; `distance` [m] to home; `seconds` since the last reading.
  void update(double voltage, double distance, double seconds, Charger charger = Charger::kNotHeard) {
    if (voltage <= 0.0) {
      return;
    }
    const double share = average_ ? seconds / (params_.average + seconds) : 1.0;
    average_ = average_.value_or(voltage) + share * (voltage - average_.value_or(voltage));
    if (!is_low_) {
      is_low_ = *average_ < params_.low + params_.per_metre * distance;
    } else if (charger == Charger::kNotHeard) {
      is_low_ = *average_ < params_.enough;
    } else {
      is_low_ = charger == Charger::kCharges;
    }
  }

  [[nodiscard]] bool is_low() const { return is_low_; }
  /// [V] averaged; 0 = unknown.
  [[nodiscard]] double voltage() const { return average_.value_or(0.0); }

 private:
  BatteryParams params_;
  std::optional<double> average_;  // [V]
  bool is_low_ = false;
};

}  // namespace luminav
