#pragma once

#include <cstdint>
#include <luminav/motors_command_t.hpp>
#include <luminav/robot_status_t.hpp>
#include <luminav/stop_t.hpp>
#include <optional>
#include <vector>

#include "drivers/contract/clause.hpp"

namespace luminav {

/// Holds ROBOT_STATUS against the STOPs and MOTORS_COMMANDs that were sent: echoed, obeyed, latched.
class RequestWatch {
 public:
  void hear(const stop_t& message);
  void hear(const motors_command_t& message);
  void hear(const robot_status_t& message);
  [[nodiscard]] std::vector<Clause> clauses() const {
    return {stop_echo_, stop_latch_, motors_echo_, motors_state_, motors_rest_};
  }

 private:
  struct Request {
    std::int64_t id = 0;
    bool wish = false;       // engaged, enable
    std::int64_t utime = 0;  // [us] newest ROBOT_STATUS when it was first heard
    bool is_obeyed = false;  // once; what a person does at the robot later is his
  };
  [[nodiscard]] double age(const Request& request) const;  // [s]

  std::int64_t now_ = 0;  // [us] newest ROBOT_STATUS
  std::optional<Request> stop_;
  std::optional<Request> motors_;
  std::optional<robot_status_t> last_;
  Clause stop_echo_{"STOP: ROBOT_STATUS echoes stop_id and stop_engaged within 0.5 s"};
  Clause stop_latch_{"STOP: stays in force until it is released"};
  Clause motors_echo_{"MOTORS_COMMAND: ROBOT_STATUS echoes its id within 0.5 s"};
  Clause motors_state_{"MOTORS_COMMAND: the motors are what was asked for within 3 s"};
  Clause motors_rest_{"STOP: releasing it switches no motors on"};
};

}  // namespace luminav
