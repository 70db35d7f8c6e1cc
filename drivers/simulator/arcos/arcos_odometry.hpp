#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "drivers/p3dx/arcos/information_packet.hpp"
#include "services/common/geometry/angle.hpp"

namespace luminav {

/// What the simulated controller knows from its encoders: wheel travel, wheel speeds, and the registers of its pose,
/// which the client may set to zero.
class ArcosOdometry {
 public:
  /// `wheel_base` [m] turns wheel travel into the heading.
  explicit ArcosOdometry(double wheel_base) : wheel_base_(wheel_base) {}

  /// The wheels went `left` and `right` [m] within `dt` [s].
  void add(double dt, double left, double right) {
    const double travel = 0.5 * (left + right);
    const double turn = (right - left) / wheel_base_;
    x_ += travel * std::cos(theta_ + 0.5 * turn);
    y_ += travel * std::sin(theta_ + 0.5 * turn);
    theta_ += turn;
    left_total_ += left;
    right_total_ += right;
    constexpr double kSpeedTime = 0.03;  // [s] over which the wheel speeds are averaged
    const double share = std::min(1.0, dt / kSpeedTime);
    left_speed_ += share * (left / dt - left_speed_);
    right_speed_ += share * (right / dt - right_speed_);
  }
  void set_origin() { x_ = y_ = theta_ = 0.0; }

  [[nodiscard]] double theta() const { return theta_; }                                 // [rad] not wrapped
  [[nodiscard]] double distance() const { return 0.5 * (left_total_ + right_total_); }  // [m] whatever the origin
  [[nodiscard]] EncoderPacket encoders(double ticks_per_metre) const {
    return {static_cast<std::int32_t>(std::llround(left_total_ * ticks_per_metre)),
            static_cast<std::int32_t>(std::llround(right_total_ * ticks_per_metre))};
  }
  /// Writes the pose, the speeds and whether it moves.
  void write_to(InformationPacket& packet) const {
    constexpr double kMovingSpeed = 0.005;  // [m/s] of a wheel
    packet.x_mm = wrapped(1000.0 * x_);
    packet.y_mm = wrapped(1000.0 * y_);
    packet.heading = heading_units(theta_);
    packet.left_mm_s = wrapped(1000.0 * left_speed_);
    packet.right_mm_s = wrapped(1000.0 * right_speed_);
    packet.moving = std::max(std::abs(left_speed_), std::abs(right_speed_)) > kMovingSpeed;
    packet.turn_rate = static_cast<int>(std::lround(10.0 * degrees((right_speed_ - left_speed_) / wheel_base_)));
  }
  /// An angle [rad] in the robot's units, 4096 per turn.
  [[nodiscard]] static int heading_units(double theta) {
    constexpr double kHeadingUnits = 4096.0 / (2.0 * kPi);  // per radian
    return wrapped(std::remainder(theta * kHeadingUnits, 4096.0));
  }

 private:
  [[nodiscard]] static std::int16_t wrapped(double value) {
    return static_cast<std::int16_t>(std::llround(value) & 0xFFFF);
  }

  double wheel_base_;
  double x_ = 0.0;  // [m] registers
  double y_ = 0.0;
  double theta_ = 0.0;
  double left_total_ = 0.0;  // [m] wheel travel
  double right_total_ = 0.0;
  double left_speed_ = 0.0;  // [m/s] measured
  double right_speed_ = 0.0;
};

}  // namespace luminav
