#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/navigation_status_t.hpp>
#include <luminav/pose_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "drivers/simulator/world/scenario.hpp"
#include "services/common/process/subscriber.hpp"
#include "tests/evaluation/report/run_report.hpp"

namespace luminav {

/// Plays the user of a scenario: tells the start pose if it is known, drives by hand or sends the goals one by one as
/// requests are sent (repeated until echoed), and notes how each ended. Its time is SIM_TRUTH's.
class Mission {
 public:
  /// `patrol`: the goals are sent over and over; it never finishes, and only goals that ended count.
  Mission(lcm::LCM& lcm, const Scenario& scenario, bool patrol = false);

  /// All goals ended and all drives driven.
  [[nodiscard]] bool is_finished() const;
  [[nodiscard]] const std::vector<GoalResult>& results() const { return results_; }
  /// Of the current goal's request; 0 = it is not requested yet.
  [[nodiscard]] std::int64_t goal_id() const { return goal_id_; }
  /// Somebody else's request has the robot; the current goal is sent again once that has ended.
  [[nodiscard]] bool is_interrupted() const { return goal_id_ != 0 && navigation_ && navigation_->goal_id > goal_id_; }
  /// Results with the goals that were never ended counted as missed.
  [[nodiscard]] std::vector<GoalResult> final_results() const;
  [[nodiscard]] std::size_t current_goal() const { return results_.size(); }
  /// "" if everything went as the scenario expects, else the first thing that did not.
  [[nodiscard]] std::string failure() const;
  /// Where the robot truly stood when each goal was requested, world.
  [[nodiscard]] const std::vector<Pose2>& request_poses() const { return request_poses_; }
  /// True way driven [m] between the request of a goal and its end.
  [[nodiscard]] double driven_for_goal(std::size_t goal) const { return driven_[goal]; }

 private:
  [[nodiscard]] const ScenarioGoal& goal(std::size_t index) const {
    return scenario_.goals[index % scenario_.goals.size()];
  }
  [[nodiscard]] bool has_goal_left() const {
    return results_.size() < scenario_.goals.size() || (patrol_ && !scenario_.goals.empty());
  }
  void on_truth(const sim_truth_t& truth);
  void on_navigation(const navigation_status_t& status) { navigation_ = status; }
  void on_robot_status(const robot_status_t& status);
  void on_pose(const pose_t& pose) { pose_ = pose; }
  void tell_start(const sim_truth_t& truth);
  void send_goal(std::int64_t utime);
  void watch_goal(const sim_truth_t& truth);
  void watch_foreign_goal(std::int64_t utime);
  void finish_goal(const sim_truth_t& truth, bool arrived);
  /// Somebody bumps into the robot after the current goal has ended.
  [[nodiscard]] bool is_bumped_after_end(std::int64_t utime) const;

  lcm::LCM& lcm_;
  Scenario scenario_;
  bool patrol_;
  Subscriber subscriber_;
  std::optional<navigation_status_t> navigation_;
  std::optional<pose_t> pose_;
  std::optional<sim_truth_t> truth_;
  std::optional<sim_truth_t> standing_;  // the newest truth with the robot where its own wheels took it
  std::vector<GoalResult> results_;
  std::vector<Pose2> request_poses_;
  std::vector<double> driven_;      // [m] for each requested goal
  std::int64_t first_utime_ = 0;    // [us]
  std::int64_t start_id_ = 0;       // of the INITIAL_POSE that tells a known start; 0 = not told yet
  std::int64_t goal_id_ = 0;        // 0 = the current goal is not requested yet
  std::int64_t requested_at_ = 0;   // [us]
  std::int64_t last_sent_ = 0;      // [us]
  std::int64_t ended_since_ = 0;    // [us] the current goal's state is final since then; 0 = it is not
  std::int64_t drive_started_ = 0;  // [us]
  std::int64_t teleop_session_ = 0;
  std::int32_t teleop_sequence_ = 0;
};

}  // namespace luminav
