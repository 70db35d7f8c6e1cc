#pragma once

#include <lcm/lcm-cpp.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <string>
#include <vector>

#include "services/common/process/subscriber.hpp"

namespace luminav {

/// Notes in plain sentences when the robot changes its mind, and what truly happens to it: the log of a failed run.
class RunLog {
 public:
  explicit RunLog(lcm::LCM& lcm);

  /// The last lines, oldest first.
  [[nodiscard]] std::vector<std::string> lines() const { return lines_; }

 private:
  void on_truth(const sim_truth_t& truth);
  void on_pose(const pose_t& pose);
  void on_navigation(const navigation_status_t& status);
  void on_control(const control_status_t& status);
  void add(const std::string& who, const std::string& what);

  double elapsed_ = 0.0;  // [s]
  std::int64_t first_utime_ = 0;
  int contacts_ = 0;
  int carries_ = 0;
  int pose_state_ = -1;
  int navigation_state_ = -1;
  int control_state_ = -1;
  std::vector<std::string> lines_;
  Subscriber subscriber_;
};

}  // namespace luminav
