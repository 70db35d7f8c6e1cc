#pragma once

#include <cstdint>
#include <luminav/velocity_command_t.hpp>
#include <string>

namespace luminav {

/// The VELOCITY_COMMANDs that were heard, and which of them a base has to obey.
class CommandLedger {
 public:
  static constexpr double kTimeout = 0.3;  ///< [s] age at which a command moves nothing any more

  struct Command {
    std::int64_t utime = 0;  // [us] of the message that it answers; 0 = none
    double linear = 0.0;     // [m/s]
    double angular = 0.0;    // [rad/s]
    [[nodiscard]] bool moves() const { return linear != 0.0 || angular != 0.0; }
  };

  /// "" when the robot of that name has to obey it, else why not. `now` [us] is the newest stamp of its ROBOT_STATUS.
  std::string hear(const velocity_command_t& message, const std::string& robot, std::int64_t now);

  /// The last that was to be obeyed.
  [[nodiscard]] const Command& last() const { return last_; }
  /// [us] since when each command that was to be obeyed wanted the motion that the last one wants, without a pause.
  [[nodiscard]] std::int64_t steady_since() const { return steady_since_; }
  /// Since the beginning.
  [[nodiscard]] std::int64_t refusable() const { return refusable_; }

 private:
  void take(const Command& command);

  std::int64_t session_ = 0;  // of the sender
  std::int32_t sequence_ = 0;
  Command last_;
  std::int64_t steady_since_ = 0;
  std::int64_t refusable_ = 0;
};

}  // namespace luminav
