#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <vector>

#include "services/localizer/hypotheses/object_tracks.hpp"

namespace luminav {

/// Checks that the fixtures in view move as the wheels say. If they do not, somebody moves the robot: odometry does not
/// know where to, and a filter that follows a fixture by sight is misled.
class OdometryConsistency {
 public:
  /// `wheel_base` [m].
  explicit OdometryConsistency(double wheel_base) : wheel_base_(wheel_base) {}

  /// One image, and the scene with it. True while the wheels do not explain, in three images in a row, how what is in
  /// view for a while moved within 0.6 s, neither as they turned nor if one or both of them slipped; and for as long at
  /// most while what is in view is too new to tell.
  [[nodiscard]] bool look(const SightingFrame& frame, const ObjectTracks& tracks, const Pose2& odom_from_robot);
  /// Relative motion across now is unknown, or the scene begins anew.
  void clear();

 private:
  /// A thing on the ceiling as one image showed it.
  struct Look {
    std::int64_t utime = 0;  // [us]
    int object = 0;
    Pose2 odom_from_robot;
    Pose2 robot_from_thing;
    Eigen::Matrix2d covariance;  // [m^2] of its place, robot frame
  };

  /// No motion of the wheels between two looks at one thing, with full, half or no grip of each, explains where it is
  /// now.
  [[nodiscard]] bool is_beyond_slip(const Look& before, const Look& now) const;
  /// It went there from image to image and did not jump.
  [[nodiscard]] bool moved_on(const Look& now) const;

  double wheel_base_;            // [m]
  std::deque<Look> looks_;       // oldest first
  int run_ = 0;                  // images that showed it, others that could not tell left out
  std::int64_t told_utime_ = 0;  // [us] of the last that could
};

}  // namespace luminav
