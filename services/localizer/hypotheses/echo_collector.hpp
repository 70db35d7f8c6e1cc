#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/common/geometry/angle.hpp"
#include "services/localizer/hypotheses/sonar_evidence.hpp"
#include "services/localizer/model/localizer.hpp"
#include "services/localizer/model/odometry_history.hpp"

namespace luminav {

/// What makes an echo new evidence.
struct EchoRules {
  double distance = 0.3;        // [m] or
  double turn = radians(30.0);  // [rad]: how far a collection must be from all earlier ones
  double surface = 0.5;         // [m] of a wall or a thing that is heard as one
  int looks = 4;                // echoes of it that count; together they have the weight of one
  int passage_looks = 2;        // likewise beams that pass a place one way: one in a hundred is silent by chance
};

/// Collects sonar echoes until the robot has moved enough for them to say something new of where it is: echoes from one
/// place repeat each other's errors, also when the robot comes by again. So do echoes of one surface from wherever they
/// are heard, for it is in the map or it is not: each counts once. Whoever goes to and fro beside a box that the map
/// doesn't know would else prove that the box is a wall. Likewise beams that pass a place one way, silent ones too.
class EchoCollector {
 public:
  EchoCollector(const SonarRing& sonar, const EchoRules& rules)
      : sonar_(sonar), rules_(rules), heard_utime_(sonar.robot_from_sonar.size(), 0) {}

  /// Keeps the readings that are of a known disc, neither too near nor echoes near the ring's end of range, and silence
  /// of discs that heard something lately: a dead one says nothing.
  void add(const SonarScan& scan);
  /// Forgets the echoes and where they were heard: relative motion across now is unknown.
  void clear();
  /// Every place and surface is as good as new, for whoever has not heard it.
  void forget_places();
  void advance(const Pose2& delta);
  /// The newest reading of each disc, and as passages alone two in a row before it that went farther, as beside a
  /// doorway, at most so many of either, of the last second before `utime` [us], in the robot frame of that instant,
  /// without those of surfaces and passages that have had their weight; empty while the robot has not moved enough or
  /// fewer than three discs have readings.
  [[nodiscard]] std::vector<PlacedEcho> take(std::int64_t utime, const OdometryHistory& history, std::size_t max);

 private:
  /// A square of the odometry frame from which echoes came, or which beams of one direction passed.
  struct Surface {
    int column = 0;
    int row = 0;
    int sector = kNoSector;  // of the direction
    int looks = 0;
  };
  static constexpr int kNoSector = -1;

  /// A disc's readings of the last second in the robot frame of `now`, the newest first.
  [[nodiscard]] std::vector<PlacedEcho> place_readings(int disc, std::int64_t utime, const OdometryReading& now,
                                                       const OdometryHistory& history) const;
  [[nodiscard]] bool has_listened_at(const Pose2& odom_from_robot) const;
  /// Counts a look at a place and returns what it weighs.
  double look_at(const Eigen::Vector2d& place_in_odom, int sector, int max_looks);

  SonarRing sonar_;
  EchoRules rules_;
  std::vector<SonarEcho> echoes_;          // silent ones too
  std::vector<std::int64_t> heard_utime_;  // [us] last echo, by disc; 0 = none yet
  std::vector<Pose2> places_;              // odom, of the latest collections
  std::vector<Surface> surfaces_;          // those heard first lately
  double distance_since_ = 1e9;            // [m]
  double turn_since_ = 0.0;                // [rad]
};

}  // namespace luminav
