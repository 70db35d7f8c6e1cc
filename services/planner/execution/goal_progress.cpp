#include "services/planner/execution/goal_progress.hpp"

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kProgress = 0.2;        // [m] of the path that count as progress
constexpr double kForgotten = 1.0;       // [m] of progress after which attempts count from zero again
constexpr double kStuckPatience = 0.3;   // times the patience with a controller that calls itself stuck,
constexpr double kMovingPatience = 3.0;  // and with one that moves the robot
constexpr int kMaxMissed = 3;            // the controller says "there" and the pose says "no"

}  // namespace

void GoalProgress::begin_path(double length, std::int64_t now) {
  since_ = now;
  replace_path(length);
}

void GoalProgress::replace_path(double length) {
  left_ = length;
  if (attempts_ == 0) {
    attempts_left_ = length;
  }
}

bool GoalProgress::has_stalled(double distance_left, const Situation& situation) {
  if (!situation.can_move || distance_left < left_ - kProgress) {
    since_ = situation.now;
    left_ = distance_left;
    if (distance_left < attempts_left_ - kForgotten) {
      attempts_ = 0;
      attempts_left_ = distance_left;
    }
    return false;
  }
  const bool is_stuck = situation.control && situation.control->stuck;
  const bool moves = situation.control && situation.control->seconds_without_progress < params_.no_progress_time;
  const double patience = is_stuck ? kStuckPatience : moves ? kMovingPatience : 1.0;
  return seconds_of(situation.now - since_) >= patience * params_.no_progress_time;
}

void GoalProgress::count_attempt(std::int64_t now) {
  if (++attempts_ == 1) {
    first_attempt_ = now;
  }
}

bool GoalProgress::count_missed() {
  return ++missed_ <= kMaxMissed;
}

bool GoalProgress::has_tried_long(std::int64_t now) const {
  return seconds_of(now - first_attempt_) >= params_.stuck_time;
}

bool GoalProgress::is_stuck(bool by_people, std::int64_t now) const {
  const double limit = by_people ? params_.people_time : params_.stuck_time;
  return attempts_ > params_.attempts && seconds_of(now - first_attempt_) >= limit;
}

}  // namespace luminav
