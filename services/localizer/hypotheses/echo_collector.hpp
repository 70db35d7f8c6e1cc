#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/common/ceiling/odometry_history.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/hypotheses/hypothesis.hpp"
#include "services/localizer/hypotheses/sonar_evidence.hpp"
#include "services/localizer/model/localizer.hpp"

namespace luminav {

/// Collects sonar echoes until the robot has moved enough for new evidence. Echoes heard at one place repeat each
/// other's errors, also on a later visit. Echoes of one surface do so from everywhere, since the map has it or not:
/// each surface counts once. Otherwise driving back and forth past an unmapped box would turn it into evidence for a
/// wall. The same holds for beams that pass a place in one direction, silent ones included.
class EchoCollector {
 public:
  EchoCollector(const SonarRing& sonar, const HypothesisParams& params)
      : sonar_(sonar), params_(params), heard_utime_(sonar.robot_from_sonar.size(), 0) {}

  /// Keeps readings of known discs that are neither too near nor near the end of the range, and silence of discs that
  /// heard something lately: a dead disc is silent too.
  void add(const SonarScan& scan);
  /// Forgets the echoes and where they were heard: relative motion across now is unknown.
  void clear();
  /// Which list of hypotheses hears what is taken from now on: to another one than before, which has heard nothing yet,
  /// every place and surface is new evidence again.
  void begin_for(int list);
  void advance(const Pose2& delta);
  /// Returns at most `max` echoes of the last second before `utime` [us], the newest of each disc, in the robot frame
  /// of that instant, and at most `max` passages: two readings in a row before it that went farther, as beside a
  /// doorway. Leaves out surfaces and passages that have had their weight. Empty while the robot has not moved enough
  /// or fewer than three discs have readings.
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

  void forget_places();

  /// A disc's readings of the last second in the robot frame of `now`, the newest first.
  [[nodiscard]] std::vector<PlacedEcho> place_readings(int disc, std::int64_t utime, const OdometryReading& now,
                                                       const OdometryHistory& history) const;
  [[nodiscard]] bool has_listened_at(const Pose2& odom_from_robot) const;
  /// Counts a look at a place and returns what it weighs.
  double look_at(const Eigen::Vector2d& place_in_odom, int sector, int max_looks);

  SonarRing sonar_;
  HypothesisParams params_;
  int list_ = 0;                           // that hears them
  std::vector<SonarEcho> echoes_;          // silent ones too
  std::vector<std::int64_t> heard_utime_;  // [us] last echo, by disc; 0 = none yet
  std::vector<Pose2> places_;              // odom, of the latest collections
  std::vector<Surface> surfaces_;          // those heard first lately
  double distance_since_ = 1e9;            // [m]
  double turn_since_ = 0.0;                // [rad]
};

}  // namespace luminav
