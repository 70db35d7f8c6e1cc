#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/velocity_command_t.hpp>
#include <optional>
#include <string>

#include "services/common/network/command_seal.hpp"

namespace luminav {

/// Drives a base through all that the contract speaks of: turns on the spot, a hand's breadth forth and back, silence,
/// commands that must be refused, STOP and release, motors off and on. Each ROBOT_STATUS is answered; its stamps are
/// the only clock. Half a metre of free floor, or wheels off the ground.
class BaseExercise {
 public:
  BaseExercise(lcm::LCM& lcm, const std::string& robot, std::optional<CommandKey> key = {});

  /// The next tick. Begins with a second of listening.
  void hear(const robot_status_t& message);
  /// Somebody else commands: it does not begin, or gives up.
  void hear(const velocity_command_t& message);

  [[nodiscard]] bool is_done() const;
  /// Why it gave up, one sentence; "" = it did not.
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  /// What it does now, for people.
  [[nodiscard]] std::string doing() const;

 private:
  void begin_phase(const robot_status_t& message);
  void request(const robot_status_t& message);
  void command(const robot_status_t& message);

  CommandPublisher commands_;
  std::string robot_;
  std::size_t phase_ = 0;
  std::int64_t phase_began_ = 0;   // [us]
  std::int64_t last_request_ = 0;  // [us]
  std::int64_t request_id_ = 0;    // of this phase
  std::int64_t session_ = 0;       // of the commands
  std::int32_t sequence_ = 0;
  std::string refusal_;
};

}  // namespace luminav
