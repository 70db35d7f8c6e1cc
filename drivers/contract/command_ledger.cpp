#include "drivers/contract/command_ledger.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kAhead = 50'000;  // [us] a stamp of the base cannot lie ahead of it
constexpr std::int64_t kTimeoutMicroseconds = 300'000;

}  // namespace

std::string CommandLedger::hear(const velocity_command_t& message, const std::string& robot, std::int64_t now) {
  if (message.robot != robot) {
    return "for another robot";
  }
  std::string why;
  if (message.linear_y != 0.0) {
    why = "sideways";
  } else if (now - message.utime > kTimeoutMicroseconds) {
    why = "too old";
  } else if (message.utime > now + kAhead) {
    why = "from the future";
  } else if (message.session < session_ || (message.session == session_ && message.sequence <= sequence_)) {
    why = "out of sequence";
  }
  if (!why.empty()) {
    ++refusable_;
    return why;
  }
  session_ = message.session;
  sequence_ = message.sequence;
  take({message.utime, message.linear_x, message.angular_z});
  return {};
}

void CommandLedger::take(const Command& command) {
  const bool goes_on = command.linear == last_.linear && command.angular == last_.angular && last_.utime != 0 &&
                       command.utime - last_.utime <= kTimeoutMicroseconds;
  steady_since_ = goes_on ? steady_since_ : command.utime;
  last_ = command;
}

}  // namespace luminav
