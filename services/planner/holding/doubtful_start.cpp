#include "services/planner/holding/doubtful_start.hpp"

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kStill = 4.0;             // [s] standing still at first
constexpr double kTurnTime = 4.0;          // [s] for each turn
constexpr double kTurn = 2.0 * kPi / 3.0;  // [rad] less than half a turn, so that it goes on in one direction

}  // namespace

bool DoubtfulStart::begin(std::int64_t now) {
  begin_anew(now);
  return ++doubts_ <= max_doubts_;
}

void DoubtfulStart::begin_anew(std::int64_t now) {
  since_ = now;
  turns_ = 0;
}

std::optional<PathOrder> DoubtfulStart::look_round(const Pose2& world_from_robot, std::int64_t now) {
  if (seconds_of(now - since_) < kStill + turns_ * kTurnTime) {
    return std::nullopt;
  }
  ++turns_;
  return path_to_wait({world_from_robot.position()}, wrap_angle(world_from_robot.theta + kTurn));
}

bool DoubtfulStart::is_over(std::int64_t now) const {
  return seconds_of(now - since_) >= kTime;
}

}  // namespace luminav
