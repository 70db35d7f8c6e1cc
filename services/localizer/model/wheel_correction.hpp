#pragma once

#include <cmath>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// What a calibration drive found out about the wheels: by how much they differ from what the base believes.
struct WheelCorrection {
  double scale = 0.0;  // fraction: metres per metre of odometry, minus 1
  double ratio = 0.0;  // fraction: right wheel over left wheel, minus 1
  double base = 0.0;   // fraction: distance between the wheels over the believed one, minus 1

  [[nodiscard]] bool is_none() const { return scale == 0.0 && ratio == 0.0 && base == 0.0; }

  /// The step that the robot really made, for way [m] and turn [rad] as odometry tells them.
  template <typename Number>
  static void correct(const Number& scale, const Number& ratio, const Number& base, double wheel_base, double distance,
                      double turn, Number& true_distance, Number& true_turn) {
    const Number left = (1.0 + scale) * (1.0 - 0.5 * ratio) * (distance - 0.5 * wheel_base * turn);
    const Number right = (1.0 + scale) * (1.0 + 0.5 * ratio) * (distance + 0.5 * wheel_base * turn);
    true_distance = 0.5 * (left + right);
    true_turn = (right - left) / (wheel_base * (1.0 + base));
  }
};

/// Odometry with the wheels' errors taken out, step by step.
class CorrectedOdometry {
 public:
  CorrectedOdometry(const WheelCorrection& correction, double wheel_base)
      : correction_(correction), wheel_base_(wheel_base) {}

  /// odom_from_robot as it would be with the right wheels; a first reading, or one after `restart`, is taken as it is.
  Pose2 correct(const Pose2& odom_from_robot) {
    if (correction_.is_none() || !has_last_) {
      corrected_ = odom_from_robot;
    } else {
      const Pose2 step = last_.inverse() * odom_from_robot;
      const double direction = step.x >= 0.0 ? 1.0 : -1.0;
      double distance = 0.0;
      double turn = 0.0;
      WheelCorrection::correct(correction_.scale, correction_.ratio, correction_.base, wheel_base_,
                               direction * std::hypot(step.x, step.y), step.theta, distance, turn);
      // along the mean heading of the step, as odometry itself does
      corrected_ =
          corrected_ * Pose2{distance * std::cos(0.5 * turn), distance * std::sin(0.5 * turn), wrap_angle(turn)};
    }
    last_ = odom_from_robot;
    has_last_ = true;
    return corrected_;
  }
  void restart() { has_last_ = false; }

 private:
  WheelCorrection correction_;
  double wheel_base_;  // [m]
  bool has_last_ = false;
  Pose2 last_;
  Pose2 corrected_;
};

}  // namespace luminav
