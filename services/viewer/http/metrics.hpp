#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/node_status_t.hpp>
#include <luminav/odometry_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <map>
#include <optional>
#include <string>

#include "services/common/process/subscriber.hpp"

namespace luminav {

/// Counts and keeps what Prometheus asks for: processes by their NODE_STATUS, and what the robot did since this was
/// made. Of a message that was never heard there is no line. Reads no clock.
class Metrics {
 public:
  explicit Metrics(lcm::LCM& lcm);

  /// Prometheus' text format 0.0.4. `now` [us] is this host's clock: processes that were silent for a minute are left
  /// out.
  [[nodiscard]] std::string text(std::int64_t now);

 private:
  struct Process {
    node_status_t status;
    std::int64_t restarts = 0;  // seen since this was made
    std::int64_t heard = 0;     // [us]; 0 = since the last `text`
  };
  struct Contacts {
    std::int64_t bumper = 0;
    std::int64_t stall = 0;
    bool is_bumping = false;
    bool is_stalled = false;
  };

  [[nodiscard]] std::string process_lines() const;
  [[nodiscard]] std::string robot_lines() const;
  [[nodiscard]] std::string navigation_lines() const;

  void on_odometry(const odometry_t& message);
  void on_robot_status(const robot_status_t& message);
  void on_navigation_status(const navigation_status_t& message);
  void on_pose(const pose_t& message);
  void on_node_status(const node_status_t& message);
  void on_sim_truth(const sim_truth_t& message);

  Subscriber subscriber_;
  std::map<std::pair<std::string, std::string>, Process> processes_;  // by process and host
  std::optional<robot_status_t> robot_;
  std::optional<navigation_status_t> navigation_;
  std::optional<odometry_t> odometry_;
  std::optional<pose_t> pose_;
  std::optional<sim_truth_t> truth_;
  double distance_ = 0.0;                      // [m]
  std::map<std::int8_t, std::int64_t> goals_;  // by the state in which they ended
  Contacts contacts_;
};

}  // namespace luminav
