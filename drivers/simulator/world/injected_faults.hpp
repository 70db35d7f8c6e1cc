#pragma once

#include <vector>

#include "drivers/simulator/world/scenario.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// Faults that events inject for a while: wheels that slip, devices that are unplugged, encoders that count nothing,
/// sonar discs that hear nothing or repeat what they heard last. Times are [s] since the beginning.
class InjectedFaults {
 public:
  explicit InjectedFaults(const SonarRing& ring)
      : maximum_range_(ring.maximum_range), discs_(ring.robot_from_sonar.size(), {0.0, 0.0, ring.maximum_range}) {}

  /// Takes slip, unplug, deafen, stick and freeze; the simulated camera freezes by itself.
  void start(const ScenarioEvent& event, double now);

  /// Ground covered per wheel travel.
  [[nodiscard]] double grip(double now) const { return now < slip_until_ ? grip_ : 1.0; }
  [[nodiscard]] bool is_camera_unplugged(double now) const { return now < camera_unplugged_until_; }
  [[nodiscard]] bool is_serial_unplugged(double now) const { return now < serial_unplugged_until_; }
  /// What an encoder counts of the way [m] that its wheel turned; 0 = left, 1 = right.
  [[nodiscard]] double count(int wheel, double way, double now) const { return now < frozen_until_[wheel] ? 0.0 : way; }
  /// What a disc says that measures a range [m].
  [[nodiscard]] double hear(int disc, double range, double now);

 private:
  struct DiscFault {
    double deaf_until = 0.0;
    double stuck_until = 0.0;
    double heard = 0.0;  // [m] last
  };

  double maximum_range_;  // [m] nothing heard
  std::vector<DiscFault> discs_;
  double grip_ = 1.0;
  double slip_until_ = 0.0;
  double camera_unplugged_until_ = 0.0;
  double serial_unplugged_until_ = 0.0;
  double frozen_until_[2] = {0.0, 0.0};
};

}  // namespace luminav
