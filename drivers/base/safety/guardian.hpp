#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace luminav {

struct GuardianParams {
  double silence = 0.3;     // [s] without a beat: the driver hangs
  double brake_time = 1.0;  // [s] at most from the first STOP to motors off: speed over deceleration, and a margin
};

/// What the guardian says to a robot and hears from it, in that robot's own bytes.
struct GuardedRobot {
  std::vector<std::uint8_t> halt;   // stand; said again and again, also behind a command that was cut off
  std::vector<std::uint8_t> leave;  // motors off, end of the session
  /// Takes bytes from the robot: whether both wheels stand by its newest word, nothing when it said none.
  std::function<std::optional<bool>(std::span<const std::uint8_t>)> hear_wheels;
};

/// A child process that holds a copy of the line to the robot. When the driver dies, or beats no longer, it says halt,
/// lets the robot brake until its wheels stand, and ends the session. It ignores what ends a driver politely and goes
/// with it.
class Guardian {
 public:
  /// Forks: to be built before there are threads. Throws std::runtime_error when it cannot.
  Guardian(const GuardianParams& params, const GuardedRobot& robot);
  Guardian(const Guardian&) = delete;
  Guardian& operator=(const Guardian&) = delete;
  /// Releases the line and waits for the child.
  ~Guardian();

  /// From now on it guards this line; -1 = none. The copy is its own: the descriptor may be closed here.
  void watch_line(int descriptor);
  /// The driver lives. To be called at least every 0.1 s.
  void beat();
  [[nodiscard]] bool alive() const { return socket_ >= 0; }
  [[nodiscard]] pid_t process() const { return child_; }

 private:
  void send(char message, int descriptor);

  int socket_ = -1;
  pid_t child_ = -1;
};

}  // namespace luminav
