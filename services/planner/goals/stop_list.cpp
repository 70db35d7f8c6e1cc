#include "services/planner/goals/stop_list.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kArrivalError = 0.04;  // [m] the controller stops within this of a path's end
constexpr double kRounding = 1e-6;      // [m] and [rad]

}  // namespace

void StopList::begin(const GoalRequest& goal, int index) {
  goal_ = goal;
  index_ = std::clamp(index, 0, count() - 1);
  retries_ = failures_in_a_row_ = skipped_ = 0;
}

void StopList::next() {
  index_ = (index_ + 1) % count();
  retries_ = 0;
}

StopList::AfterFailure StopList::failed(bool is_final) {
  ++failures_in_a_row_;
  if (!is_final && goal_.policy == FailurePolicy::kRetry && retries_ < params_.retries) {
    ++retries_;
    return AfterFailure::kTryAgain;
  }
  const bool all_failed = failures_in_a_row_ >= count();
  if (is_final || goal_.policy != FailurePolicy::kSkip || is_last() || all_failed) {
    return AfterFailure::kGiveUp;
  }
  ++skipped_;
  return AfterFailure::kGoOn;
}

double StopList::planned_tolerance() const {
  return std::max(0.5 * tolerance(), tolerance() - kArrivalError);
}

bool StopList::is_at_stop(const Pose2& world_from_robot) const {
  const bool near = (world_from_robot.position() - stop().pose.position()).norm() <= tolerance() + kRounding;
  const bool turned = !stop().has_theta || std::abs(wrap_angle(world_from_robot.theta - stop().pose.theta)) <=
                                               heading_tolerance() + kRounding;
  return near && turned;
}

}  // namespace luminav
