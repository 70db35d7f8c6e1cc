#include "services/planner/execution/people_in_the_way.hpp"

#include <utility>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kMemory = 20.0;  // [s] so long ago, people are still in the way every now and then
constexpr double kSetOff = 0.05;  // [m] that the robot has driven when it no longer waits for somebody, ...
constexpr double kLetGo = 1.0;    // [s] ... or for so long nobody has been in its way

}  // namespace

void PeopleInTheWay::hear(const Situation& situation) {
  if (situation.control && situation.control->yielding) {
    last_yield_ = situation.now;
  }
}

std::optional<std::string> PeopleInTheWay::cause(const Situation& situation) {
  const Eigen::Vector2d robot = situation.world_from_robot.position();
  if (situation.control && situation.control->yielding) {
    waits_ = {robot, situation.control->reason};
  } else if (waits_ && ((robot - waits_->place).norm() > kSetOff || seconds_of(situation.now - last_yield_) > kLetGo)) {
    waits_.reset();
  }
  return waits_ ? std::optional(waits_->cause) : std::nullopt;
}

bool PeopleInTheWay::were_met_lately(std::int64_t now) const {
  return last_yield_ != 0 && seconds_of(now - last_yield_) < kMemory;
}

bool PeopleInTheWay::may_be_left() {
  return !std::exchange(has_left_, true);
}

}  // namespace luminav
