#pragma once

#include <cstdint>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <luminav/motors_command_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/stop_t.hpp>
#include <luminav/supervision_t.hpp>
#include <luminav/velocity_command_t.hpp>
#include <optional>
#include <string>
#include <utility>

#include "drivers/base/base_config.hpp"
#include "drivers/base/safety/life_sign.hpp"
#include "drivers/base/safety/stop_latch.hpp"
#include "drivers/base/safety/velocity_gate.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/subscriber.hpp"

namespace luminav {

/// What a base does about what it is told, each in its own protocol. `now` [us].
class CommandedBase {
 public:
  /// A command was taken: tells the robot.
  virtual void follow(std::int64_t now) = 0;
  /// A stop began or ended: tells the robot, however short ago the last change was.
  virtual void follow_stop(std::int64_t now) = 0;
  /// Somebody asks for the motors, or for none.
  virtual void switch_motors(std::int64_t now, bool enable) = 0;
  /// Time was lost: drops what waits on the line and tells the robot to stand, before anything else is said.
  virtual void stand_after_gap(std::int64_t now) = 0;
  /// The guardian may have acted on the line: begins a new session after `pause` [us], in which it may still do so.
  virtual void begin_anew(std::int64_t now, std::int64_t pause) = 0;

 protected:
  ~CommandedBase() = default;
};

/// What a base obeys: VELOCITY_COMMAND while it is fresh and somebody watches, STOP before it, MOTORS_COMMAND once
/// each. After a gap in its own time nothing from before is obeyed.
class CommandDesk {
 public:
  CommandDesk(lcm::LCM& lcm, const BaseConfig& config, const Clock& clock, std::optional<CommandKey> key,
              CommandedBase& base);

  /// The time; to be called before anything is said on the line, which others may have used while this process slept.
  std::int64_t wake();
  /// Keeps the stop and tells the guardian that the driver lives; to be called at the end of each poll.
  void finish_poll(std::int64_t now);
  void report_life(std::function<void()> tell_guardian) { life_.report_to(std::move(tell_guardian)); }

  /// The robot stands for as long as there is a reason, "" = no more; true when it begins to.
  bool hold(const std::string& why);
  /// From now on nothing moves the robot; true when it stands by its own `measured` speeds.
  bool stand_for_good(const DriveVelocity& measured);
  /// What the robot is to do now.
  [[nodiscard]] DriveVelocity wanted(std::int64_t now) const;
  /// Why that is nothing, the stop before a hazard before a stall, one sentence; "" when a command is in force.
  [[nodiscard]] std::string reason(std::int64_t now, const std::string& hazard, bool stall_left,
                                   bool stall_right) const;
  /// ROBOT_STATUS at 50 Hz, with what is known here, when one is due. `may_move`: connected, and powered.
  std::optional<robot_status_t> due_status(std::int64_t now, bool may_move);

  [[nodiscard]] VelocityGate& gate() { return gate_; }
  [[nodiscard]] const VelocityGate& gate() const { return gate_; }
  [[nodiscard]] const StopLatch& stop() const { return stop_; }
  [[nodiscard]] const Subscriber& subscriber() const { return subscriber_; }

 private:
  void on_velocity_command(const velocity_command_t& message);
  void on_stop(const stop_t& message);
  void on_supervision(const supervision_t& message);
  void on_motors_command(const motors_command_t& message);
  void obey_stop(std::int64_t now, std::int64_t id, bool engaged, const std::string& sender);
  [[nodiscard]] bool is_unsupervised(std::int64_t now) const;

  std::string robot_;
  double supervised_;  // [s] 0 = never asked
  const Clock& clock_;
  CommandedBase& base_;
  VelocityGate gate_;
  StopLatch stop_;
  LifeSign life_;
  std::int64_t last_wake_ = 0;            // [us]
  std::int64_t last_motors_command_ = 0;  // id
  std::int64_t watched_;                  // [us] when somebody last watched, or this began
  std::string held_because_;
  bool standing_still_ = false;   // for good
  double deceleration_;           // [m/s^2]
  std::int64_t next_status_ = 0;  // [us]
  std::int32_t status_sequence_ = 0;
  Subscriber subscriber_;
};

}  // namespace luminav
