#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <vector>

#include "services/localizer/hypotheses/object_tracks.hpp"
#include "services/localizer/integrity/slipping_wheels.hpp"
#include "services/localizer/integrity/tracking_rules.hpp"

namespace luminav {

/// Checks that the fixtures in view move as the wheels say. If they do not, somebody moves the robot: odometry does not
/// know where to, and a filter that follows a fixture by sight is misled.
class OdometryConsistency {
 public:
  /// `wheel_base` [m]
  OdometryConsistency(double wheel_base, const TrackingRules& rules) : wheel_base_(wheel_base), rules_(rules) {}

  /// One image: its sightings with their object in the scene. True while the wheels do not explain how what is in view
  /// for longest moved within the rules' time, neither as they turned nor if one or both of them slipped, in as many
  /// images in a row as the rules ask for; and for as long at most while what is in view is too new to tell.
  [[nodiscard]] bool look(const SightingFrame& frame, const std::vector<int>& objects, const ObjectTracks& tracks,
                          const Pose2& odom_from_robot);
  /// Relative motion across now is unknown, or the scene begins anew.
  void clear();

 private:
  struct Look : CeilingLook {
    int object = 0;
  };

  /// Since `before`, or since they stand, the wheels do not explain where it is now.
  [[nodiscard]] bool is_displaced(const Look& before, const Look& now) const;
  /// It went there from image to image and did not jump.
  [[nodiscard]] bool moved_on(const Look& now) const;

  double wheel_base_;  // [m]
  TrackingRules rules_;
  std::deque<Look> looks_;            // oldest first
  Pose2 odom_at_frame_;               // odom_from_robot at the image before
  std::int64_t at_rest_since_ = 0;    // [us] of the first image since which the wheels stand
  int run_ = 0;                       // images that showed it, others that could not tell left out
  std::int64_t displaced_utime_ = 0;  // [us] of the last of them
};

}  // namespace luminav
