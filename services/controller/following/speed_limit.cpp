#include "services/controller/following/speed_limit.hpp"

#include <cmath>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kHeld = 1.0;      // [s] of stamps
constexpr double kSlowest = 0.05;  // [m/s] below it the robot would stand, for which there is STOP
constexpr double kFastest = 5.0;   // [m/s]

bool is_of(std::int64_t utime, std::int64_t now) {
  return std::abs(seconds_between(utime, now)) <= kHeld;
}

}  // namespace

bool HeldSpeedLimit::take(const SpeedLimit& limit, std::int64_t now) {
  if (!(limit.max_speed >= kSlowest && limit.max_speed <= kFastest) || !is_of(limit.utime, now)) {
    return false;
  }
  const std::optional<SpeedLimit> held = at(now);
  if (!held || held->sender == limit.sender || limit.max_speed <= held->max_speed) {
    held_ = limit;
  }
  return true;
}

std::optional<SpeedLimit> HeldSpeedLimit::at(std::int64_t now) const {
  return held_ && is_of(held_->utime, now) ? held_ : std::nullopt;
}

}  // namespace luminav
