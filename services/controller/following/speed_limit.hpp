#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace luminav {

/// How fast somebody wants the robot to drive at most.
struct SpeedLimit {
  std::int64_t utime = 0;   // [us]
  double max_speed = 0.0;   // [m/s]
  std::string sender = {};  // for people
};

/// The limit that holds: the newest of its sender, unless somebody else's is lower, for a second of stamps. What cannot
/// be a limit is none.
class HeldSpeedLimit {
 public:
  /// False for a speed that nobody drives by, or a stamp that is a second away from `now` [us].
  bool take(const SpeedLimit& limit, std::int64_t now);
  [[nodiscard]] std::optional<SpeedLimit> at(std::int64_t now) const;

 private:
  std::optional<SpeedLimit> held_;
};

}  // namespace luminav
