#include "services/planner/goals/goal_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/planner/goals/goal_sentences.hpp"

namespace luminav {

GoalCycle::GoalCycle(const GoalCycleParams& params, const RoutePlannerParams& planner, std::vector<Door> doors)
    : params_(params), planner_params_(planner), planner_(planner), doors_(std::move(doors)) {}

// ---------------------------------------------------------------------------------------------------- requests

void GoalCycle::start(const GoalRequest& goal, std::int64_t now) {
  begin(goal, 0, now);
}

void GoalCycle::resume_at(const GoalRequest& goal, int stop_index, std::int64_t now) {
  begin(goal, std::clamp(stop_index, 0, static_cast<int>(goal.stops.size()) - 1), now);
}

void GoalCycle::show_paused(const GoalRequest& goal, int stop_index, const std::string& why, std::int64_t now) {
  resume_at(goal, stop_index, now);
  enter(Phase::kPaused, NavigationState::kPaused,
        fmt::format("kept from before on the way to {}: {}; resume?", place_of(stop()), why));
}

void GoalCycle::begin(const GoalRequest& goal, int stop_index, std::int64_t now) {
  now_ = now;
  goal_ = goal;
  stop_ = stop_index;
  report_ = {};
  report_.goal_id = goal.id;
  report_.stop_index = stop_;
  report_.stop_count = static_cast<int>(goal.stops.size());
  report_.target = stop();
  suspects_.clear();
  search_ = {};
  has_left_people_ = false;
  map_dirty_ = true;
  last_tracking_ = 0;
  last_plan_ = 0;
  attempts_ = losses_ = suspicions_ = waits_beside_ = arrival_failures_ = retries_ = failures_in_a_row_ = skipped_ = 0;
  set_path({});
  phase_ = Phase::kNone;  // a search that was under way begins anew, with all its time
  enter(Phase::kLocalizing, NavigationState::kLocalizing, "");
}

void GoalCycle::cancel(std::int64_t id, std::int64_t now) {
  now_ = now;
  report_.goal_id = id;
  if (is_active()) {
    finish(NavigationState::kCancelled, fmt::format("cancelled on the way to {}", place_of(stop())));
  } else if (report_.state != NavigationState::kArrived) {
    report_.state = NavigationState::kCancelled;
    report_.cause = "nothing to cancel";
  }
}

void GoalCycle::pause(std::int64_t id, std::int64_t now) {
  now_ = now;
  report_.goal_id = id;
  if (is_active() && phase_ != Phase::kPaused) {
    search_.last.reset();
    set_path({});
    enter(Phase::kPaused, NavigationState::kPaused, fmt::format("paused on the way to {}", place_of(stop())));
  }
}

void GoalCycle::resume(std::int64_t id, std::int64_t now) {
  now_ = now;
  report_.goal_id = id;
  if (phase_ == Phase::kPaused) {
    goal_.id = id;  // its paths carry the id that the status carries, or the controller waits for another
    last_tracking_ = 0;
    enter(Phase::kLocalizing, NavigationState::kLocalizing, "");
  }
}

void GoalCycle::refuse(std::int64_t id, const std::string& why, std::int64_t now) {
  now_ = now;
  report_ = {};
  report_.goal_id = id;
  finish(NavigationState::kNoPath, why);
}

void GoalCycle::map_changed(const OccupancyGrid& grid, int received, int tiles) {
  grid_ = &grid;
  tiles_received_ = received;
  tiles_ = tiles;
  map_dirty_ = true;
}

// ---------------------------------------------------------------------------------------------------- phases

void GoalCycle::enter(Phase phase, NavigationState state, const std::string& cause) {
  if (phase != phase_) {
    phase_since_ = now_;
  }
  phase_ = phase;
  report_.state = state;
  report_.cause = cause;
  cause_before_.reset();
}

void GoalCycle::finish(NavigationState state, const std::string& cause) {
  set_path({});
  report_.distance_left = 0.0;
  report_.target.reset();
  enter(Phase::kNone, state, cause);
}

void GoalCycle::fail_stop(NavigationState state, const std::string& cause) {
  set_path({});
  suspects_.clear();
  ++failures_in_a_row_;
  const bool hopeless = state == NavigationState::kLost;
  if (!hopeless && goal_.policy == FailurePolicy::kRetry && retries_ < params_.retries) {
    ++retries_;
    enter(Phase::kRetrying, NavigationState::kWaiting,
          fmt::format("{}; trying again in {:.0f} s ({} of {})", cause, params_.retry_wait, retries_, params_.retries));
    return;
  }
  const bool is_last = !goal_.loop && stop_ + 1 >= report_.stop_count;
  const bool all_failed = failures_in_a_row_ >= report_.stop_count;
  if (hopeless || goal_.policy != FailurePolicy::kSkip || is_last || all_failed) {
    finish(state, cause);
    return;
  }
  ++skipped_;
  next_stop();
}

void GoalCycle::next_stop() {
  stop_ = (stop_ + 1) % report_.stop_count;
  report_.stop_index = stop_;
  report_.target = stop();
  attempts_ = losses_ = suspicions_ = waits_beside_ = arrival_failures_ = retries_ = 0;
  suspects_.clear();
  search_ = {};
  has_left_people_ = false;
  map_dirty_ = true;
  last_plan_ = 0;
  enter(Phase::kPlanning, NavigationState::kPlanning, "");
}

void GoalCycle::reached_stop() {
  failures_in_a_row_ = 0;
  set_path({});
  report_.distance_left = 0.0;
  if (stop().wait > 0.0) {
    enter(Phase::kDwelling, NavigationState::kWaiting,
          fmt::format("staying at {} for {:.0f} s", place_of(stop()), stop().wait));
    return;
  }
  if (!goal_.loop && stop_ + 1 >= report_.stop_count) {
    finish(NavigationState::kArrived,
           skipped_ > 0 ? fmt::format("{} of {} stops were skipped", skipped_, report_.stop_count) : "");
    return;
  }
  next_stop();
}

void GoalCycle::lose_place(const std::string& why) {
  search_.last.reset();  // found again elsewhere, it has not driven there
  if (losses_ == 0 || report_.distance_left < loss_left_ - kAttemptsForgotten) {
    losses_ = 0;
    loss_left_ = report_.distance_left;
  }
  if (++losses_ > params_.losses) {
    fail_stop(NavigationState::kLost, fmt::format("lost its place {} times {:.1f} m before {}: {}", params_.losses,
                                                  report_.distance_left, place_of(stop()), why));
    return;
  }
  set_path({});
  enter(Phase::kLocalizing, NavigationState::kLocalizing, why);
}

bool GoalCycle::is_localized(const Situation& situation) {
  if (situation.tracking) {
    last_tracking_ = now_;
    if (cause_before_) {
      report_.cause = *cause_before_;
      cause_before_.reset();
    }
    if (phase_ == Phase::kLocalizing) {
      enter(Phase::kPlanning, NavigationState::kPlanning, "");
      last_plan_ = 0;
      attempts_ = 0;  // it has been elsewhere since; `losses` bounds this
      // it stands there already: no need to drive off and lose the pose again
      if (losses_ > 0 && is_at_stop(situation.world_from_robot)) {
        reached_stop();
        return false;
      }
    }
    return true;
  }
  if (phase_ != Phase::kLocalizing) {
    if (last_tracking_ != 0 && seconds_since(last_tracking_) < params_.tracking_grace) {
      if (!cause_before_) {
        cause_before_ = report_.cause;
      }
      report_.cause = situation.localization;
      return false;
    }
    lose_place(situation.localization);
    if (phase_ == Phase::kNone) {
      return false;
    }
  }
  report_.cause = situation.localization;
  if (!situation.can_move) {
    report_.cause = situation.cannot_move;
    phase_since_ = now_;  // a robot that may not move cannot search
  }
  if (seconds_since(phase_since_) > params_.lost_timeout) {
    fail_stop(NavigationState::kLost, fmt::format("gave up after searching for {:.0f} s: {}", params_.lost_timeout,
                                                  situation.localization.empty() ? "no pose" : situation.localization));
  }
  return false;
}

void GoalCycle::update(const Situation& situation) {
  if (situation.now < now_ - 1'000'000) {  // the robot's clock started anew: nothing that was timed holds
    phase_since_ = progress_since_ = first_attempt_ = situation.now;
    last_tracking_ = last_plan_ = last_yield_ = hold_since_ = last_facing_ = 0;
    for (Suspect& suspect : suspects_) {
      suspect.until = situation.now;
    }
  }
  now_ = situation.now;
  if (situation.control && situation.control->yielding) {
    last_yield_ = now_;
  }
  if (phase_ == Phase::kNone || phase_ == Phase::kPaused) {
    return;
  }
  if (phase_ == Phase::kDwelling) {
    if (seconds_since(phase_since_) >= stop().wait) {
      if (!goal_.loop && stop_ + 1 >= report_.stop_count) {
        finish(NavigationState::kArrived, "");
      } else {
        next_stop();
      }
    }
    return;
  }
  if (phase_ == Phase::kRetrying) {
    if (seconds_since(phase_since_) >= params_.retry_wait) {
      attempts_ = arrival_failures_ = 0;
      search_ = {};
      enter(Phase::kPlanning, NavigationState::kPlanning, "");
    }
    return;
  }
  if (!is_localized(situation) || phase_ == Phase::kNone) {
    return;
  }
  const auto expired = [&](const Suspect& suspect) { return suspect.until <= now_; };
  if (std::erase_if(suspects_, expired) > 0) {
    map_dirty_ = true;
  }
  if (searches_in_vain(situation)) {
    fail_stop(NavigationState::kNoPath, fmt::format("no way to {} found in {:.0f} m of driving, {:.1f} m were expected",
                                                    place_of(stop()), search_.driven, search_.first_length));
    return;
  }
  suspect_touched(situation);
  switch (phase_) {
    case Phase::kPlanning:
    case Phase::kSuspectingPlace:
      plan(situation);
      break;
    case Phase::kFollowing:
      update_following(situation);
      break;
    case Phase::kHolding:
      update_hold(situation);
      break;
    default:
      break;
  }
}

void GoalCycle::set_path(const Polyline& points) {
  if (points.empty() && path_.points.empty() && path_.goal_id == goal_.id) {
    return;
  }
  if (path_.sequence == 0) {
    // a restarted planner must not count below its predecessor
    path_.sequence = static_cast<int>(now_ / 1'000'000 % 1'000'000'000);
  }
  ++path_.sequence;
  path_.goal_id = goal_.id;
  path_.stop_index = stop_;
  path_.points = points;
  path_.tolerance = tolerance();
  path_.heading_tolerance = heading_tolerance();
  at_ = 0;
  if (!goal_.stops.empty()) {
    path_.has_theta = stop().has_theta;
    path_.theta = stop().pose.theta;
  }
}

void GoalCycle::set_path_to_wait(const Polyline& points, double theta) {
  set_path(points);
  path_.tolerance = params_.hold_tolerance;
  path_.has_theta = true;
  path_.theta = theta;
}

}  // namespace luminav
