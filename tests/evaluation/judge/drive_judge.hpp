#pragma once

#include <deque>
#include <lcm/lcm-cpp.hpp>
#include <luminav/control_status_t.hpp>
#include <luminav/sim_truth_t.hpp>
#include <luminav/velocity_command_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/process/subscriber.hpp"
#include "tests/evaluation/report/run_report.hpp"

namespace luminav {

/// Free space to both sides of a robot that drives along a corridor.
struct CorridorGap {
  double nearer = 0.0;  // [m] from the outline to the wall on the nearer side
  double middle = 0.0;  // [m] the same if it drove in the middle
};

/// The corridor round a pose: walls on both sides, parallel to its heading over a metre, 1.2 to 3 m apart; nothing
/// elsewhere.
std::optional<CorridorGap> corridor_gap(const PriorMap& walls, const Pose2& world_from_robot, double half_width);

/// Watches how the robot drives: what it touches, whether its heading command swings, and how far it keeps from the
/// walls of corridors.
class DriveJudge {
 public:
  DriveJudge(lcm::LCM& lcm, const WorldTruth& world);

  [[nodiscard]] DriveResult result() const;

 private:
  void on_truth(const sim_truth_t& truth);
  void on_control(const control_status_t& status) { control_ = status; }
  void on_command(const velocity_command_t& command);
  [[nodiscard]] ContactEvent contact(const sim_truth_t& truth, bool is_hard) const;

  WorldTruth world_;
  double half_width_ = 0.0;  // [m] of the robot
  Subscriber subscriber_;
  std::optional<control_status_t> control_;
  std::vector<ContactEvent> contacts_;
  std::int64_t first_utime_ = 0;
  std::int64_t last_corridor_ = 0;  // [us]
  int count_ = 0;                   // contacts so far
  int hard_count_ = 0;
  std::vector<double> corridor_shares_;

  std::int64_t last_command_ = 0;
  double last_turn_ = 0.0;               // [rad/s] last one that counts
  std::deque<std::int64_t> turnabouts_;  // [us] of the last two seconds
  double oscillation_ = 0.0;             // [s]
};

}  // namespace luminav
