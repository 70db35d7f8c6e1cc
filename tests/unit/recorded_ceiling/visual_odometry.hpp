#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/ceiling/fixture_sighting.hpp"

namespace luminav::testing {

/// Odometry from sightings alone, for recordings without wheels: constant velocity, corrected by aligning what is seen
/// with what was seen lately. Which fixture of the building anything is does not matter to it.
class VisualOdometry {
 public:
  /// Takes in the next image's sightings; returns odom_from_robot at that image.
  Pose2 step(const std::vector<FixtureSighting>& sightings);
  /// Of (x, y, theta) of the last step's motion, as far as the sightings of this image tell.
  [[nodiscard]] const Eigen::Matrix3d& covariance() const { return covariance_; }

 private:
  struct SeenThing {
    Pose2 odom_from_thing;
    int last_frame = 0;
  };
  Pose2 align(const Pose2& predicted, const std::vector<FixtureSighting>& sightings);
  [[nodiscard]] const SeenThing* thing_at(const Pose2& odom_from_sighting) const;

  std::vector<SeenThing> things_;
  Pose2 odom_from_robot_;
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
  Pose2 velocity_;  // robot's motion from one image to the next
  int frame_ = 0;
};

}  // namespace luminav::testing
