#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/geometry/pose2.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/model/wall_field.hpp"

namespace luminav {

/// The last stretch that the robot drove, by odometry: a pose from which it leads through a wall is wrong.
class TrajectoryCheck {
 public:
  void clear();
  /// One odometry step. True when a stretch is complete and is to be compared with the walls.
  [[nodiscard]] bool advance(const Pose2& delta);
  /// Points of the stretch [m, robot frame of now].
  [[nodiscard]] std::vector<Eigen::Vector2d> points() const;

 private:
  std::vector<Pose2> poses_;  // in a frame that stands still
  Pose2 now_;
  double distance_since_ = 0.0;  // [m] since the last stretch was complete
};

/// Log-likelihood that a robot believed there drove along `trail` [m, robot frame] without going through a wall: how
/// far the belief must be off for that. 0 = not at all; bounded below.
double log_likelihood_of_trail(const PoseBelief& belief, const std::vector<Eigen::Vector2d>& trail,
                               const WallField& walls);

}  // namespace luminav
