#pragma once

#include <cstdint>
#include <deque>
#include <luminav/odometry_t.hpp>
#include <optional>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// The last ODOMETRY messages of one session: where the robot was at an instant, and a little beyond.
class RecentOdometry {
 public:
  /// Takes up a message of the same session, not older than the last.
  void add(const odometry_t& message);
  void clear() {
    messages_.clear();
    began_ = 0;
  }

  [[nodiscard]] bool empty() const { return messages_.empty(); }
  /// Not when empty.
  [[nodiscard]] const odometry_t& newest() const { return messages_.back(); }
  /// Stamp of the first message since it was cleared; 0 when empty.
  [[nodiscard]] std::int64_t began() const { return began_; }
  /// Between two messages interpolated, after the newest driven on for 0.2 s at most; nothing before the oldest.
  [[nodiscard]] std::optional<Pose2> odom_from_robot_at(std::int64_t utime) const;
  /// Farther ahead of the newest than that: no measurement of this clock's. Not when empty.
  [[nodiscard]] bool is_too_far_ahead(std::int64_t utime) const;

 private:
  std::deque<odometry_t> messages_;  // oldest first
  std::int64_t began_ = 0;           // [us]
};

}  // namespace luminav
