#pragma once

#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/velocity_command_t.hpp>
#include <optional>
#include <string>

#include "services/common/process/clock.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {

/// What the robot says of itself, for the report of a test: never for the verdict, which is the truth's.
class RobotWatch {
 public:
  RobotWatch(lcm::LCM& lcm, const Clock& clock);

  [[nodiscard]] const std::optional<navigation_status_t>& navigation() const { return navigation_; }
  [[nodiscard]] const std::optional<control_status_t>& control() const { return control_; }
  [[nodiscard]] const std::optional<pose_t>& pose() const { return pose_; }
  [[nodiscard]] const std::optional<robot_status_t>& robot() const { return robot_; }
  [[nodiscard]] bool is_following() const;
  [[nodiscard]] bool is_tracking() const;
  /// When the first command, and the first pose that may be trusted, came after `utime` [us], on this clock.
  [[nodiscard]] std::optional<std::int64_t> commanded_after(std::int64_t utime) const;
  [[nodiscard]] std::optional<std::int64_t> tracked_after(std::int64_t utime) const;
  /// When the driver first said after `utime` [us] that the robot answers and its motors are on.
  [[nodiscard]] std::optional<std::int64_t> connected_after(std::int64_t utime) const;
  /// Where it believes to be, what it does and why, in one line.
  [[nodiscard]] std::string sentence() const;

 private:
  void on_navigation(const navigation_status_t& status) { navigation_ = status; }
  void on_control(const control_status_t& status) { control_ = status; }
  void on_pose(const pose_t& pose);
  void on_robot(const robot_status_t& status);
  void on_command(const velocity_command_t& command);

  const Clock& clock_;
  Subscriber subscriber_;
  std::optional<navigation_status_t> navigation_;
  std::optional<control_status_t> control_;
  std::optional<pose_t> pose_;
  std::optional<robot_status_t> robot_;
  // arrivals of the last minute [us]
  std::deque<std::int64_t> commands_;
  std::deque<std::int64_t> tracking_poses_;
  std::deque<std::int64_t> connected_;
};

}  // namespace luminav
