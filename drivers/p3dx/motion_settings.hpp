#pragma once

#include <cstdint>
#include <vector>

#include "drivers/p3dx/arcos/configuration_packet.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// The limits of motion that the robot's controller is to keep by itself: told when a session begins, and again once a
/// second while the configuration that the robot sends back says otherwise, because nothing is acknowledged.
class MotionSettings {
 public:
  /// `angular_deceleration` [rad/s^2].
  MotionSettings(const MotionLimits& limits, double angular_deceleration)
      : limits_(limits), angular_deceleration_(angular_deceleration) {}

  /// A new session with a robot that reaches these speeds, [m/s] and [rad/s].
  void begin(double maximum_linear, double maximum_angular);
  /// The frames to send now [us], if any. `robot` is what it has told of itself, null while it has not.
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> poll(std::int64_t now, const ConfigurationPacket* robot);

 private:
  [[nodiscard]] bool in_force(const ConfigurationPacket& robot) const;
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> frames() const;

  MotionLimits limits_;
  double angular_deceleration_;
  int sent_ = 0;              // how often in this session
  std::int64_t sent_at_ = 0;  // [us]
};

}  // namespace luminav
