#include "services/planner/goals/goal_keeper.hpp"

#include <exception>
#include <utility>

namespace luminav {
namespace {

constexpr std::int64_t kPeriod = 20'000'000;  // [us] it is kept anew: how long ago tells whether it goes on

}  // namespace

GoalKeeper::GoalKeeper(const std::filesystem::path& folder, GoalCircumstances here)
    : store_(folder), here_(std::move(here)) {}

void GoalKeeper::update(const GoalProgressNow& progress, std::int64_t now) {
  try {
    if (!progress.is_active) {
      if (kept_) {
        store_.forget();
        kept_.reset();
      }
    } else if (is_due(progress, now)) {
      keep(progress.stop_index, progress.is_paused, now);
    }
    error_.clear();
  } catch (const std::exception& error) {
    error_ = error.what();
  }
}

void GoalKeeper::end(const GoalProgressNow& progress, std::int64_t now) {
  try {
    if (progress.is_active) {
      keep(progress.stop_index, true, now);
    }
  } catch (const std::exception& error) {
    error_ = error.what();
  }
}

bool GoalKeeper::is_due(const GoalProgressNow& progress, std::int64_t now) const {
  return !kept_ || kept_->goal.id != accepted_.id || kept_->pose_index != progress.stop_index ||
         kept_->asks != progress.is_paused || now - kept_->kept.utime > kPeriod || now < kept_->kept.utime;
}

void GoalKeeper::keep(std::int32_t stop_index, bool asks, std::int64_t now) {
  here_.utime = now;
  StoredGoal stored{accepted_, stop_index, asks, here_};
  store_.keep(stored);
  kept_ = std::move(stored);
}

}  // namespace luminav
