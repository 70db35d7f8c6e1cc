#include "services/mapper/pose_history.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kLongestGap =
    400'000;                                 // [us] between two poses; ODOMETRY comes at 10 Hz, a lost one makes 200 ms
constexpr double kJump = 0.10;               // [m] a correction of the estimate between two poses, not a movement
constexpr double kTurnJump = radians(15.0);  // [rad] at most 0.6 rad/s over two periods, and something for corrections

}  // namespace

void PoseHistory::add(const Entry& entry) {
  if (!entries_.empty() && entry.utime <= entries_.back().utime) {
    return;
  }
  entries_.push_back(entry);
  while (entries_.back().utime - entries_.front().utime > kMemory) {
    entries_.pop_front();
  }
}

std::optional<Pose2> PoseHistory::trusted_at(std::int64_t utime) const {
  const auto after = std::lower_bound(entries_.begin(), entries_.end(), utime,
                                      [](const Entry& entry, std::int64_t value) { return entry.utime < value; });
  if (after == entries_.end()) {
    return std::nullopt;
  }
  if (after->utime == utime) {
    return after->trusted ? std::optional(after->world_from_robot) : std::nullopt;
  }
  if (after == entries_.begin()) {
    return std::nullopt;
  }
  const Entry& from = *std::prev(after);
  const Entry& to = *after;
  const std::int64_t gap = to.utime - from.utime;
  const double reachable = kJump + std::max(from.speed, to.speed) * seconds_of(gap);
  if (!from.trusted || !to.trusted || gap > kLongestGap ||
      distance(from.world_from_robot, to.world_from_robot) > reachable ||
      std::abs(wrap_angle(to.world_from_robot.theta - from.world_from_robot.theta)) > kTurnJump) {
    return std::nullopt;
  }
  const double fraction = static_cast<double>(utime - from.utime) / static_cast<double>(gap);
  return interpolate(from.world_from_robot, to.world_from_robot, fraction);
}

}  // namespace luminav
