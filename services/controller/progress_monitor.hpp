#pragma once

#include <cstdint>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

struct ProgressParams {
  double distance = 0.2;                // [m] that count as progress
  double turn = radians(45.0);          // [rad] that count as progress
  double turns_most = 2.0 * 2.0 * kPi;  // [rad] of turning without getting anywhere; more is spinning
};

/// Tells for how long a robot that wants to move has got nowhere.
class ProgressMonitor {
 public:
  explicit ProgressMonitor(const ProgressParams& params) : params_(params) {}

  void restart(std::int64_t now, const Pose2& odom_from_robot) {
    since_ = now;
    place_ = heading_ = odom_from_robot;
    turned_ = 0.0;
  }
  /// Seconds without progress, after taking up where it is now.
  double update(std::int64_t now, const Pose2& odom_from_robot) {
    if (since_ == 0 || now < since_) {
      restart(now, odom_from_robot);
    }
    if (distance(place_, odom_from_robot) > params_.distance) {
      restart(now, odom_from_robot);
    }
    const double turn = std::abs(wrap_angle(odom_from_robot.theta - heading_.theta));
    if (turn > params_.turn) {
      heading_ = odom_from_robot;
      turned_ += turn;
      if (turned_ < params_.turns_most) {
        since_ = now;
      }
    }
    return 1e-6 * static_cast<double>(now - since_);
  }

 private:
  ProgressParams params_;
  std::int64_t since_ = 0;  // [us]
  Pose2 place_;             // odom
  Pose2 heading_;           // odom
  double turned_ = 0.0;     // [rad] since the place changed
};

}  // namespace luminav
