#pragma once

#include <cstdint>
#include <deque>
#include <luminav/odometry_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <optional>
#include <vector>

#include "drivers/contract/clause.hpp"

namespace luminav {

/// Holds what odometry says against itself: the pose must move as the twist says, sessions must be those of
/// ROBOT_STATUS, and stamps of both must be of one clock.
class OdometryWatch {
 public:
  void hear(const odometry_t& message);
  void hear(const robot_status_t& message);
  [[nodiscard]] std::vector<Clause> clauses() const { return {pose_, session_, clock_}; }

 private:
  void judge_pose();

  std::deque<odometry_t> window_;  // of one session, a second long
  std::optional<odometry_t> last_;
  std::int64_t differs_since_ = 0;  // [us] the session from that of ROBOT_STATUS; 0 = it does not
  Clause pose_{"ODOMETRY: the pose moves as linear and angular say, theta in (-pi, pi]"};
  Clause session_{"ODOMETRY: its session is that of ROBOT_STATUS, and is not 0"};
  Clause clock_{"ODOMETRY: stamped by the clock of ROBOT_STATUS, at most 0.5 s behind it"};
};

}  // namespace luminav
