#pragma once

#include <cstdint>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/localizer.hpp"
#include "services/localizer/odometry_history.hpp"
#include "services/localizer/sonar_evidence.hpp"

namespace luminav {

/// Collects sonar echoes until the robot has moved enough for them to say something new of where it is: echoes from one
/// place repeat each other's errors, also when the robot comes by again. Whoever goes to and fro beside a box that the
/// map doesn't know would else prove that the box is a wall.
class EchoCollector {
 public:
  /// `way` [m] or `turn` [rad]: how far a collection must be from all earlier ones.
  EchoCollector(const SonarRing& sonar, double way, double turn) : sonar_(sonar), way_(way), turn_(turn) {}

  /// Keeps the echoes that are from a known disc and neither too near nor near the ring's end of range.
  void add(const SonarScan& scan);
  /// Forgets the echoes and where they were heard: relative motion across now is unknown.
  void clear();
  /// Every place is as good as new, for whoever has not heard it.
  void forget_places() { places_.clear(); }
  void advance(const Pose2& delta);
  /// The newest echo of each disc of the last second before `utime` [us], in the robot frame of that instant; empty
  /// while the robot has not moved enough or fewer than three discs heard something.
  [[nodiscard]] std::vector<PlacedEcho> take(std::int64_t utime, const OdometryHistory& history);

 private:
  [[nodiscard]] bool has_listened_at(const Pose2& odom_from_robot) const;

  SonarRing sonar_;
  double way_;
  double turn_;
  std::vector<SonarEcho> echoes_;
  std::vector<Pose2> places_;  // odom, of the latest collections
  double way_since_ = 1e9;     // [m]
  double turn_since_ = 0.0;    // [rad]
};

}  // namespace luminav
