#pragma once

#include <cstdint>
#include <luminav/control_status_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <optional>

#include "services/common/process/stamp_guard.hpp"
#include "services/planner/execution/goal_executor.hpp"

namespace luminav {

/// How the robot stands, by the newest POSE, ROBOT_STATUS and CONTROL_STATUS.
class SituationInput {
 public:
  struct Verdict {
    bool is_refused = false;      // older than the last, or impossible
    bool is_new_session = false;  // the robot's clock begins anew
    bool is_tick = false;         // its stamp is the time now
  };
  Verdict take(const pose_t& message);
  /// A tick where no pose comes: that is what a plan is made from.
  Verdict take(const robot_status_t& message);
  void take(const control_status_t& message, std::int64_t now);

  /// It is that late [us].
  void begin_tick(std::int64_t now);
  /// What was touched has been told.
  void end_tick() { has_touched_ = false; }
  [[nodiscard]] Situation at(std::int64_t now) const;

 private:
  [[nodiscard]] ControlReport control_report() const;

  StampGuard pose_stamps_;
  StampGuard robot_stamps_;
  StampGuard control_stamps_;
  std::optional<pose_t> pose_;
  std::optional<robot_status_t> robot_;
  std::optional<control_status_t> control_;
  std::int64_t control_heard_ = 0;  // [us] of our ticks
  bool has_touched_ = false;        // something, forwards on its path, since the last tick
};

}  // namespace luminav
