#pragma once

#include <algorithm>
#include <cmath>

namespace luminav {

/// Three lead-acid batteries of 12 V and 7.2 Ah in parallel, as the Pioneer 3 manual has them: 252 Wh that last eight
/// to ten hours of driving.
class Battery {
 public:
  static constexpr double kFull = 12.9;   // [V] at rest
  static constexpr double kEmpty = 11.0;  // [V] where the robot gives up

  explicit Battery(double voltage = 12.6) : charge_(kCapacity * (voltage - kEmpty) / (kFull - kEmpty)) {}

  /// Time goes on by `dt` [s] at a speed [m/s] and turn rate [rad/s].
  void step(double dt, bool motors_enabled, double linear, double angular) {
    const double power =
        kElectronics + (motors_enabled ? kMotors : 0.0) + kDriving * std::abs(linear) + kTurning * std::abs(angular);
    charge_ = std::max(0.0, charge_ - power * dt / 3600.0);
  }
  /// Terminal voltage [V]; between full and empty it falls about linearly with the charge.
  [[nodiscard]] double voltage() const { return kEmpty + (kFull - kEmpty) * charge_ / kCapacity; }

 private:
  static constexpr double kCapacity = 252.0;    // [Wh]
  static constexpr double kElectronics = 12.0;  // [W] controller, sonars, a small computer
  static constexpr double kMotors = 4.0;        // [W] powered and standing
  static constexpr double kDriving = 25.0;      // [W per m/s]
  static constexpr double kTurning = 5.0;       // [W per rad/s]
  double charge_;                               // [Wh]
};

}  // namespace luminav
