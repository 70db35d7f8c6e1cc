#pragma once

#include <cmath>

#include "services/common/geometry/angle.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/localizer/integrity/tracking_rules.hpp"

namespace luminav {

/// Whether somebody may have carried the robot off since its pose last predicted a fixture: for that it must stand, or
/// have its motors off.
class KidnapOpportunity {
 public:
  static constexpr int kHaltFrames = 3;  ///< images in a row without wheel motion: it has stood for a moment

  explicit KidnapOpportunity(const TrackingRules& rules) : rules_(rules) {}

  /// One image. True where the wheels come to rest, and have not paused since the last match: an opportunity begins.
  bool look(const Pose2& odom_from_robot) {
    const Pose2 step = odom_at_frame_.inverse() * odom_from_robot;
    const bool is_at_rest = std::hypot(step.x, step.y) < 0.001 && std::abs(step.theta) < radians(0.1);
    still_frames_ = is_at_rest ? still_frames_ + 1 : 0;
    odom_at_frame_ = odom_from_robot;
    const bool begins = still_frames_ == 1 && !has_paused_;
    has_paused_ = has_paused_ || still_frames_ >= rules_.pause_frames;
    has_halted_ = has_halted_ || still_frames_ >= kHaltFrames;
    return begins;
  }
  /// The newest image shows a fixture where the pose has it: the robot has not been carried off.
  void match() {
    still_frames_ = 0;
    has_paused_ = false;
    has_halted_ = false;
    odom_at_match_ = odom_at_frame_;
  }
  /// While the motors are off a hand may move the robot: then it counts as having stood still.
  void set_motors_off(bool off) { are_motors_off_ = off; }

  [[nodiscard]] bool was_given() const { return has_paused_ || are_motors_off_; }
  /// Nobody can have carried it off: the wheels did not even stand for a moment.
  [[nodiscard]] bool is_excluded() const { return !has_halted_ && !are_motors_off_; }
  /// The wheels did not turn before the newest image.
  [[nodiscard]] bool are_wheels_still() const { return still_frames_ > 0; }
  /// How the wheels moved the robot since the last match, in the robot frame there.
  [[nodiscard]] Pose2 since_match() const { return odom_at_match_.inverse() * odom_at_frame_; }
  /// The robot is where it was at the last match, by its wheels.
  [[nodiscard]] bool stands_still() const {
    const Pose2 moved = since_match();
    const auto moved_less = [&](double distance, double turn) {
      return std::hypot(moved.x, moved.y) < distance && std::abs(moved.theta) < turn;
    };
    // a robot that is lifted while driving rolls on a little after the last image
    return moved_less(kStillDistance, kStillTurn) ||
           (still_frames_ >= rules_.vanish_frames && moved_less(kStopDistance, kStopTurn));
  }

 private:
  static constexpr double kStillDistance = 0.02;      // [m] since the last match: the robot stands still
  static constexpr double kStillTurn = radians(1.5);  // [rad] likewise
  static constexpr double kStopDistance = 0.15;       // [m] since the last match, and standing now: it has just stopped
  static constexpr double kStopTurn = radians(6.0);   // [rad] likewise

  TrackingRules rules_;
  Pose2 odom_at_frame_;      // odom_from_robot at the newest image
  Pose2 odom_at_match_;      // odom_from_robot at the last match
  int still_frames_ = 0;     // images in a row without wheel motion
  bool has_paused_ = false;  // it stood still for a while since the last match
  bool has_halted_ = false;  // the wheels stood for a moment since the last match
  bool are_motors_off_ = false;
};

}  // namespace luminav
