#pragma once

#include <algorithm>
#include <cmath>

#include "services/common/geometry/angle.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// Whether somebody may have carried the robot off since its pose last predicted a fixture: for that it must stand, or
/// have its motors off.
class KidnapOpportunity {
 public:
  static constexpr int kPauseFrames = 10;  ///< images in a row without wheel motion: it may have been carried

  /// One image.
  void look(const Pose2& odom_from_robot) {
    const Pose2 step = odom_at_frame_.inverse() * odom_from_robot;
    still_frames_ = is_within(step, 0.001, radians(0.1)) ? still_frames_ + 1 : 0;
    longest_still_ = std::max(longest_still_, still_frames_);
    odom_at_frame_ = odom_from_robot;
  }
  /// The newest image shows a fixture where the pose has it: the robot has not been carried off.
  void match() {
    still_frames_ = longest_still_ = 0;
    odom_at_match_ = odom_at_frame_;
  }
  /// While the motors are off a hand may move the robot: then it counts as having stood still.
  void set_motors_off(bool off) { are_motors_off_ = off; }

  [[nodiscard]] bool was_given() const { return longest_still_ >= kPauseFrames || are_motors_off_; }
  /// The wheels did not turn before the newest image.
  [[nodiscard]] bool are_wheels_still() const { return still_frames_ > 0; }
  /// How the wheels moved the robot since the last match, in the robot frame there.
  [[nodiscard]] Pose2 since_match() const { return odom_at_match_.inverse() * odom_at_frame_; }
  /// The robot stands where it was at the last match, by its wheels; one that is lifted while driving rolls on a
  /// little.
  [[nodiscard]] bool stands_still() const {
    return is_within(since_match(), kStopDistance, kStopTurn) && are_wheels_still();
  }

 private:
  static constexpr double kStopDistance = 0.15;      // [m] since the last match
  static constexpr double kStopTurn = radians(6.0);  // [rad] likewise

  [[nodiscard]] static bool is_within(const Pose2& step, double distance, double turn) {
    return std::hypot(step.x, step.y) < distance && std::abs(step.theta) < turn;
  }

  Pose2 odom_at_frame_;    // odom_from_robot at the newest image
  Pose2 odom_at_match_;    // odom_from_robot at the last match
  int still_frames_ = 0;   // images in a row without wheel motion
  int longest_still_ = 0;  // of these since the last match
  bool are_motors_off_ = false;
};

}  // namespace luminav
