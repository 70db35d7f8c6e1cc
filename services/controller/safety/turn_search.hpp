#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "services/common/geometry/angle.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/controller/safety/footprint.hpp"

namespace luminav {

/// Looks round without leaving its place: a little more than one turn, then it stands. Somebody who pushes the robot
/// elsewhere makes it look again.
class TurnSearch {
 public:
  /// What to drive now, turning at `angular` [rad/s].
  DriveTwist step(const Pose2& odom_from_robot, double angular) {
    if (!last_ || distance(place_, odom_from_robot) > kElsewhere) {
      place_ = odom_from_robot;
      turned_ = 0.0;
    } else {
      turned_ += std::abs(wrap_angle(odom_from_robot.theta - last_->theta));
    }
    last_ = odom_from_robot;
    return is_over() ? DriveTwist{} : DriveTwist{0.0, std::min(angular, kTurnRate)};
  }
  [[nodiscard]] bool is_over() const { return turned_ > kTurn; }
  void restart() { last_.reset(); }

 private:
  static constexpr double kTurn = radians(400.0);  // [rad] the first and the last view overlap
  static constexpr double kTurnRate = 0.4;         // [rad/s] pictures stay sharp
  static constexpr double kElsewhere = 0.3;        // [m] another view of the ceiling
  Pose2 place_;
  std::optional<Pose2> last_;
  double turned_ = 0.0;  // [rad]
};

}  // namespace luminav
