#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/node_status_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <tuple>

#include "services/common/process/running_system.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {

/// The newest word of each process, for one readable page.
class SystemSnapshot {
 public:
  explicit SystemSnapshot(lcm::LCM& lcm);

  /// Nobody has said anything.
  [[nodiscard]] bool is_empty() const;
  /// Robot, pose, goal, motion, and one line per process.
  [[nodiscard]] std::string page() const;
  /// The same for programs: robot, building, pose, goal, control (null where nothing was heard) and processes.
  [[nodiscard]] std::string json() const;

 private:
  void on_robot_status(const robot_status_t& message) { robot_ = message; }
  void on_pose(const pose_t& message) { pose_ = message; }
  void on_navigation_status(const navigation_status_t& message) { navigation_ = message; }
  void on_control_status(const control_status_t& message) { control_ = message; }
  void on_node_status(const node_status_t& message) {
    nodes_[{message.process, message.host, message.instance}] = message;
    system_.hear(message, 0);
  }

  Subscriber subscriber_;
  std::optional<robot_status_t> robot_;
  std::optional<pose_t> pose_;
  std::optional<navigation_status_t> navigation_;
  std::optional<control_status_t> control_;
  std::map<std::tuple<std::string, std::string, std::int64_t>, node_status_t> nodes_;  // two of one name are two
  RunningSystem system_;
};

}  // namespace luminav
