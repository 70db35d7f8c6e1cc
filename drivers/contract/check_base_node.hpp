#pragma once

#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <string>
#include <vector>

#include "drivers/contract/base_contract.hpp"
#include "drivers/contract/base_exercise.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {

struct CheckBaseOptions {
  std::string process = "p3dx";  // the driver's name in NODE_STATUS
  bool drives = false;           // moves the robot, to see what only a moving one shows
  std::optional<CommandKey> key;
};

/// Listens to a base driver and to all that is sent to it, and judges it by the contract.
class CheckBaseNode {
 public:
  CheckBaseNode(lcm::LCM& lcm, const RobotDescription& robot, const Clock& clock, const CheckBaseOptions& options);

  [[nodiscard]] std::vector<Clause> clauses() const { return contract_.clauses(); }
  /// What drives the robot; nothing when it only listens.
  [[nodiscard]] const std::optional<BaseExercise>& exercise() const { return exercise_; }
  [[nodiscard]] const std::vector<std::string>& channels() const { return subscriber_.channels(); }

 private:
  void on_odometry(const odometry_t& message) { contract_.hear(message, clock_.utime()); }
  void on_sonar(const sonar_t& message) { contract_.hear(message, clock_.utime()); }
  void on_node_status(const node_status_t& message) { contract_.hear(message, clock_.utime()); }
  void on_robot_status(const robot_status_t& message);
  void on_velocity_command(const velocity_command_t& message);
  void on_stop(const stop_t& message) { contract_.hear(message); }
  void on_motors_command(const motors_command_t& message) { contract_.hear(message); }

  const Clock& clock_;
  std::string robot_;
  BaseContract contract_;
  std::optional<BaseExercise> exercise_;
  Subscriber subscriber_;
};

/// One line per clause: whether it holds, the clause, what was seen.
std::string describe(const std::vector<Clause>& clauses);

/// The exit status: 0 when none is broken and, where `must_see_all`, each was put to the test.
int exit_status(const std::vector<Clause>& clauses, bool must_see_all);

}  // namespace luminav
