#pragma once

#include <cstdint>

#include "services/common/geometry/pose2.hpp"
#include "services/common/geometry/seconds.hpp"

namespace luminav {

/// Tells for how long a robot that wants to move has got nowhere.
class ProgressMonitor {
 public:
  void restart(std::int64_t now, const Pose2& place) {
    since_ = now;
    place_ = heading_ = place;
    turned_ = 0.0;
  }
  /// Seconds without progress, after taking up where it is now.
  double update(std::int64_t now, const Pose2& place) {
    if (since_ == 0 || now < since_) {
      restart(now, place);
    }
    if (distance(place_, place) > kDistance) {
      restart(now, place);
    }
    const double turn = std::abs(wrap_angle(place.theta - heading_.theta));
    if (turn > kTurn) {
      heading_ = place;
      turned_ += turn;
      if (turned_ < kMaxTurns) {
        since_ = now;
      }
    }
    return seconds_between(since_, now);
  }

 private:
  static constexpr double kDistance = 0.2;              // [m] that count as progress
  static constexpr double kTurn = radians(45.0);        // [rad] that count as progress
  static constexpr double kMaxTurns = 2.0 * 2.0 * kPi;  // [rad] of turning without getting anywhere; more is spinning
  std::int64_t since_ = 0;                              // [us]
  Pose2 place_;                                         // frame of the caller
  Pose2 heading_;
  double turned_ = 0.0;  // [rad] since the place changed
};

}  // namespace luminav
