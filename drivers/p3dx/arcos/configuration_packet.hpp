#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace luminav {

/// CONFIGpac: what is stored in the robot's controller and what is in force. Units mm, mm/s, degrees, 0.1 V, ms.
/// The defaults are those of a p3dx-sh.
struct ConfigurationPacket {
  std::string robot_class = "Pioneer";
  std::string subclass = "p3dx-sh";
  std::string serial = "SIM";
  int four_motors = 0;
  int turn_rate_top = 360;  // hard limits, whatever a client asks for
  int velocity_top = 1000;
  int turn_acceleration_top = 300;
  int acceleration_top = 2000;
  int pwm_maximum = 500;
  std::string name = "luminav";
  int information_cycle = 100;  // [ms] between two information packets
  int host_baud = 0;            // HOSTBAUD code
  int aux1_baud = 0;
  int has_gripper = 0;
  int has_front_sonar = 1;
  int has_rear_sonar = 1;
  int low_battery = 115;  // [0.1 V]
  int rev_count = 16570;
  int watchdog = 2000;  // [ms]; 0 = off
  int p2mpacs = 1;
  int stall_value = 200;
  int stall_count = 200;  // [ms] that motors rest after a stall
  int joystick_velocity = 400;
  int joystick_turn_rate = 100;
  int turn_rate_maximum = 150;  // in force
  int velocity_maximum = 750;
  int turn_acceleration = 100;
  int turn_deceleration = 100;
  int turn_kp = 40;
  int turn_kv = 20;
  int turn_ki = 0;
  int acceleration = 300;
  int deceleration = 300;
  int kp = 40;
  int kv = 30;
  int ki = 0;
  int front_bumpers = 0;  // segments fitted
  int rear_bumpers = 0;
  int charger = 0;
  int sonar_cycle = 40;  // [ms] between two pings of an array
  int auto_baud = 2;     // 2 = HOSTBAUD works
  int has_gyro = 0;
  int drift_factor = 0;
  int aux2_baud = 0;
  int aux3_baud = 0;
  int ticks_per_mm = 128;
  int shutdown_voltage = 110;  // [0.1 V]
  std::string firmware = "2.0";
  int gyro_clockwise = 0;
  int gyro_counter_clockwise = 0;
  int kinematics_delay = 0;  // [ms] a packet is older than its arrival
};

/// Reads the list as far as the packet goes: older firmware ends early, fields that are missing keep their defaults.
/// Nothing when it ends before the limits in force.
std::optional<ConfigurationPacket> decode_configuration(std::span<const std::uint8_t> payload);
std::vector<std::uint8_t> encode_configuration(const ConfigurationPacket& packet);

}  // namespace luminav
