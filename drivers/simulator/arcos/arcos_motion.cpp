#include "drivers/simulator/arcos/arcos_motion.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr double kMm = 1e-3;                       // [m]
constexpr double kHardestDeceleration = 3.0;       // [m/s^2] rubber on linoleum, before it slides
constexpr double kHardestTurnDeceleration = 10.0;  // [rad/s^2]

/// One step of a trapezoid: slows with `fall`, also through a change of sign, and speeds up with `rise`.
double approach(double value, double target, double rise, double fall) {
  const bool reversing = value * target < 0.0;
  if (reversing || std::abs(target) < std::abs(value)) {
    const double end = reversing ? 0.0 : target;
    return std::abs(value - end) <= fall ? end : value - std::copysign(fall, value);
  }
  return std::abs(target - value) <= rise ? target : value + std::copysign(rise, target - value);
}

/// Speed from which a stop at the distance left is still possible, and never past it within one step.
double braking_speed(double left, double deceleration, double maximum, double dt) {
  const double speed = std::min({maximum, std::sqrt(2.0 * deceleration * std::abs(left)), std::abs(left) / dt});
  return std::copysign(speed, left);
}

}  // namespace

ArcosMotion::ArcosMotion(const ConfigurationPacket& flash)
    : flash_(flash),
      maximum_velocity_(kMm * flash.velocity_maximum),
      maximum_turn_rate_(radians(flash.turn_rate_maximum)),
      acceleration_(kMm * flash.acceleration),
      deceleration_(kMm * flash.deceleration),
      turn_acceleration_(radians(flash.turn_acceleration)),
      turn_deceleration_(radians(flash.turn_deceleration)) {}

void ArcosMotion::set_maximum_velocity(int mm_s) {
  maximum_velocity_ = kMm * std::clamp(std::abs(mm_s), 0, flash_.velocity_top);
}

void ArcosMotion::set_maximum_turn_rate(int deg_s) {
  maximum_turn_rate_ = radians(std::clamp(std::abs(deg_s), 0, flash_.turn_rate_top));
}

void ArcosMotion::set_acceleration(int mm_s2) {
  if (mm_s2 != 0) {
    (mm_s2 > 0 ? acceleration_ : deceleration_) = kMm * std::min(std::abs(mm_s2), flash_.acceleration_top);
  }
}

void ArcosMotion::set_turn_acceleration(int deg_s2) {
  if (deg_s2 != 0) {
    (deg_s2 > 0 ? turn_acceleration_ : turn_deceleration_) =
        radians(std::min(std::abs(deg_s2), flash_.turn_acceleration_top));
  }
}

void ArcosMotion::set_velocity(int mm_s) {
  velocity_ = std::clamp(kMm * mm_s, -maximum_velocity_, maximum_velocity_);
  move_left_.reset();
}

void ArcosMotion::set_turn_rate(int deg_s) {
  turn_rate_ = std::clamp(radians(deg_s), -maximum_turn_rate_, maximum_turn_rate_);
  heading_.reset();
}

void ArcosMotion::move_by(int mm) {
  move_left_ = kMm * mm;
  velocity_ = 0.0;
}

void ArcosMotion::turn_to(int deg) {
  heading_ = radians(deg);
}

void ArcosMotion::turn_from_setpoint(int deg, double theta) {
  heading_ = heading_.value_or(theta) + radians(deg);
}

void ArcosMotion::turn_by(int deg, double theta) {
  heading_ = theta + radians(deg);
}

void ArcosMotion::set_wheels(double left_mm_s, double right_mm_s, double wheel_base) {
  velocity_ = std::clamp(kMm * 0.5 * (left_mm_s + right_mm_s), -maximum_velocity_, maximum_velocity_);
  turn_rate_ = std::clamp(kMm * (right_mm_s - left_mm_s) / wheel_base, -maximum_turn_rate_, maximum_turn_rate_);
  move_left_.reset();
  heading_.reset();
}

void ArcosMotion::stop() {
  velocity_ = 0.0;
  turn_rate_ = 0.0;
  move_left_.reset();
  heading_.reset();
}

void ArcosMotion::emergency_stop() {
  stop();
  emergency_ = true;
}

void ArcosMotion::freeze() {
  linear_ = 0.0;
  angular_ = 0.0;
}

double ArcosMotion::wanted_linear(double dt, double distance) {
  if (!move_left_) {
    return velocity_;
  }
  *move_left_ -= distance - last_distance_;
  return braking_speed(*move_left_, deceleration_, maximum_velocity_, dt);
}

double ArcosMotion::wanted_angular(double dt, double theta) const {
  if (!heading_) {
    return turn_rate_;
  }
  return braking_speed(wrap_angle(*heading_ - theta), turn_deceleration_, maximum_turn_rate_, dt);
}

void ArcosMotion::step(double dt, double theta, double distance) {
  const double linear = wanted_linear(dt, distance);
  const double angular = wanted_angular(dt, theta);
  last_distance_ = distance;
  emergency_ = emergency_ && (linear_ != 0.0 || angular_ != 0.0);
  const double fall = emergency_ ? kHardestDeceleration : deceleration_;
  const double turn_fall = emergency_ ? kHardestTurnDeceleration : turn_deceleration_;
  linear_ = approach(linear_, halted_ ? 0.0 : linear, acceleration_ * dt, fall * dt);
  angular_ = approach(angular_, halted_ ? 0.0 : angular, turn_acceleration_ * dt, turn_fall * dt);
}

void ArcosMotion::write_limits(ConfigurationPacket& packet) const {
  packet.velocity_maximum = static_cast<int>(std::lround(maximum_velocity_ / kMm));
  packet.acceleration = static_cast<int>(std::lround(acceleration_ / kMm));
  packet.deceleration = static_cast<int>(std::lround(deceleration_ / kMm));
  packet.turn_rate_maximum = static_cast<int>(std::lround(degrees(maximum_turn_rate_)));
  packet.turn_acceleration = static_cast<int>(std::lround(degrees(turn_acceleration_)));
  packet.turn_deceleration = static_cast<int>(std::lround(degrees(turn_deceleration_)));
}

}  // namespace luminav
