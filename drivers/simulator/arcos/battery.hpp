#pragma once

#include <algorithm>
#include <cmath>

namespace luminav {

/// Three lead-acid batteries of 12 V and 7.2 Ah in parallel, as the Pioneer 3 manual has them: 252 Wh that last eight
/// to ten hours of driving; and the fast charger, which fills them in about three.
class Battery {
 public:
  static constexpr double kFull = 12.9;   // [V] at rest
  static constexpr double kEmpty = 11.0;  // [V] where the robot gives up

  /// `voltage` [V] at rest.
  explicit Battery(double voltage = 12.6) : charge_(kCapacity * (voltage - kEmpty) / (kFull - kEmpty)) {}

  /// Time goes on by `dt` [s] at a speed [m/s] and turn rate [rad/s].
  void step(double dt, bool motors_enabled, double linear, double angular, bool on_charger = false) {
    const double power =
        kElectronics + (motors_enabled ? kMotors : 0.0) + kDriving * std::abs(linear) + kTurning * std::abs(angular);
    on_charger_ = on_charger;
    charge_ = std::clamp(charge_ + ((on_charger ? kCharger : 0.0) - power) * dt / 3600.0, 0.0, kCapacity);
  }
  /// Terminal voltage [V]; between full and empty it falls about linearly with the charge, and a charger lifts it at
  /// once.
  [[nodiscard]] double voltage() const {
    return kEmpty + (kFull - kEmpty) * charge_ / kCapacity + (on_charger_ ? kRise : 0.0);
  }
  /// As in the robot's packets: 0 none, 1 bulk, 2 overcharge, 3 float.
  [[nodiscard]] int charge_state() const {
    return !on_charger_ ? 0 : charge_ < kBulkEnd * kCapacity ? 1 : charge_ < kOverchargeEnd * kCapacity ? 2 : 3;
  }

 private:
  static constexpr double kCapacity = 252.0;      // [Wh]
  static constexpr double kElectronics = 12.0;    // [W] controller, sonars, a small computer
  static constexpr double kMotors = 4.0;          // [W] powered and standing
  static constexpr double kDriving = 25.0;        // [W per m/s]
  static constexpr double kTurning = 5.0;         // [W per rad/s]
  static constexpr double kCharger = 75.0;        // [W] 6 A
  static constexpr double kRise = 1.4;            // [V] while the charger drives its current through them
  static constexpr double kBulkEnd = 0.85;        // of the capacity
  static constexpr double kOverchargeEnd = 0.97;  // of the capacity
  double charge_;                                 // [Wh]
  bool on_charger_ = false;
};

}  // namespace luminav
