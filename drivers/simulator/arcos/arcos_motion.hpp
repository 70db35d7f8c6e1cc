#pragma once

#include <optional>

#include "drivers/p3dx/arcos/configuration_packet.hpp"

namespace luminav {

/// Motion part of the simulated controller: two independent axes, each a trapezoid under the limits in force. The later
/// command of an axis replaces the earlier one; VEL with HEAD and VEL with RVEL go together. Commands in mm and degrees
/// as on the wire, results in m/s and rad/s.
class ArcosMotion {
 public:
  explicit ArcosMotion(const ConfigurationPacket& flash);

  // Limits: negative accelerations set the deceleration, nothing exceeds the tops stored in flash.
  void set_maximum_velocity(int mm_s);
  void set_maximum_turn_rate(int deg_s);
  void set_acceleration(int mm_s2);
  void set_turn_acceleration(int deg_s2);

  // Setpoints.
  void set_velocity(int mm_s);
  void set_turn_rate(int deg_s);
  void move_by(int mm);
  /// Absolute heading of the odometry registers.
  void turn_to(int deg);
  void turn_from_setpoint(int deg, double theta);
  void turn_by(int deg, double theta);
  void set_wheels(double left_mm_s, double right_mm_s, double wheel_base);
  /// Back to standing with the deceleration in force.
  void stop();
  /// The same as hard as the wheels grip.
  void emergency_stop();
  /// At once: the wheels are blocked or without power.
  void freeze();

  /// While halted it slows down and stands; the setpoints stay and come back into force afterwards.
  void set_halted(bool halted) { halted_ = halted; }

  /// `theta` [rad] and `distance` [m] are what the odometry says since the start, not wrapped.
  void step(double dt, double theta, double distance);

  [[nodiscard]] double linear() const { return linear_; }                                         // [m/s]
  [[nodiscard]] double angular() const { return angular_; }                                       // [rad/s]
  [[nodiscard]] double heading_setpoint(double theta) const { return heading_.value_or(theta); }  // [rad]
  /// Limits in force, for CONFIGpac.
  void write_limits(ConfigurationPacket& packet) const;

 private:
  [[nodiscard]] double wanted_linear(double dt, double distance);
  [[nodiscard]] double wanted_angular(double dt, double theta) const;

  ConfigurationPacket flash_;
  double maximum_velocity_;          // [m/s]
  double maximum_turn_rate_;         // [rad/s]
  double acceleration_;              // [m/s^2]
  double deceleration_;              // [m/s^2]
  double turn_acceleration_;         // [rad/s^2]
  double turn_deceleration_;         // [rad/s^2]
  double velocity_ = 0.0;            // [m/s] setpoint
  double turn_rate_ = 0.0;           // [rad/s] setpoint
  std::optional<double> heading_;    // [rad] setpoint, not wrapped; replaces the turn rate
  std::optional<double> move_left_;  // [m] replaces the velocity
  double last_distance_ = 0.0;       // [m]
  double linear_ = 0.0;              // [m/s] in force
  double angular_ = 0.0;             // [rad/s] in force
  bool halted_ = false;
  bool emergency_ = false;
};

}  // namespace luminav
