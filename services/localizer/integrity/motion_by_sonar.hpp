#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "services/common/geometry/pose2.hpp"
#include "services/localizer/hypotheses/sonar_evidence.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/model/wall_field.hpp"

namespace luminav {

/// Detects between two fixtures that the robot moved otherwise than its wheels tell: they slipped, or it was bumped.
/// Then the sonars hear the walls elsewhere. What was heard since the last fixture is compared under the path by the
/// wheels and under paths on which, from some place on, the robot moved less or was turned. It is one likelihood ratio
/// test; robots that do neither, among boxes and people, did not pass its threshold in 37 hours.
class MotionBySonar {
 public:
  /// What the wheels do not tell of.
  struct Motion {
    double grip = 1.0;  // share of their motion that the robot makes
    double turn = 0.0;  // [rad] by which a bump turned it before
  };
  /// `half_angle` [rad] of a sonar's beam. The walls must outlive this.
  MotionBySonar(const WallField& walls, double half_angle) : walls_(walls), half_angle_(half_angle) {}

  /// Takes up echoes in the robot frame, with the odometry and the belief of that instant.
  void listen(std::span<const PlacedEcho> echoes, const Pose2& odom_from_robot, const PoseBelief& belief);
  /// Returns where the robot is if it moved so, world_from_robot of the last echoes, and begins anew.
  [[nodiscard]] std::optional<Pose2> take();
  /// Returns by how much better [log] the sonars explain that the robot is at `moved` now, for a motion at some time
  /// since the last fixture, than that it is where it is believed to be; 0 if they heard no wall.
  [[nodiscard]] double log_ratio(const Pose2& moved, const PoseBelief& belief, const Pose2& odom_from_robot) const;
  /// A fixture tells the pose, or the pose is no longer followed.
  void clear();

 private:
  /// Echoes in the robot frame of one instant.
  struct Round {
    std::vector<PlacedEcho> echoes;
    Pose2 odom_from_robot;
  };
  [[nodiscard]] std::vector<Pose2> path(const Pose2& world_from_robot, std::size_t begins, const Motion& motion) const;
  [[nodiscard]] double log_likelihood(const Round& round, const Pose2& pose, const Eigen::Matrix3d& covariance) const {
    return log_likelihood_of_echoes({pose, covariance}, round.echoes, walls_, half_angle_);
  }

  const WallField& walls_;
  double half_angle_;
  std::deque<Round> rounds_;
  std::optional<Pose2> moved_;  // world_from_robot
};

}  // namespace luminav
