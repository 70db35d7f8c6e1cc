#include "services/planner/execution/goal_executor.hpp"

#include <fmt/format.h>

#include <cassert>
#include <utility>

#include "services/common/geometry/seconds.hpp"
#include "services/planner/goals/goal_sentences.hpp"

namespace luminav {
namespace {

constexpr std::int64_t kClockJump = 1'000'000;  // [us] back: the robot's clock started anew

}  // namespace

GoalExecutor::GoalExecutor(const GoalParams& params, const RoutePlannerParams& planner, std::vector<Door> doors)
    : params_(params),
      map_(planner),
      stops_(params),
      losses_(params),
      doubtful_start_(params.losses),
      progress_(params),
      hold_(params, std::move(doors)),
      search_(params) {}

void GoalExecutor::start(const GoalRequest& goal, std::int64_t now) {
  resume_at(goal, 0, now);
}

void GoalExecutor::resume_at(const GoalRequest& goal, int stop_index, std::int64_t now) {
  now_ = now;
  stops_.begin(goal, stop_index);
  report_ = {};
  report_.goal_id = goal.id;
  report_.stop_count = stops_.count();
  losses_.begin();
  reset_for_stop();
  path_.stand_still(stops_, now_);
  phase_ = GoalPhase::kNone;  // a search that was under way begins anew, with all its time
  enter(GoalPhase::kLocalizing, NavigationState::kLocalizing, "");
}

void GoalExecutor::show_paused(const GoalRequest& goal, int stop_index, const std::string& why, std::int64_t now) {
  resume_at(goal, stop_index, now);
  enter(GoalPhase::kPaused, NavigationState::kPaused,
        fmt::format("kept from before on the way to {}: {}; resume?", place_of(stops_.stop()), why));
}

void GoalExecutor::cancel(std::int64_t id, std::int64_t now) {
  now_ = now;
  report_.goal_id = id;
  if (is_active()) {
    finish(NavigationState::kCancelled, fmt::format("cancelled on the way to {}", place_of(stops_.stop())));
  } else if (report_.state != NavigationState::kArrived) {
    report_.state = NavigationState::kCancelled;
    report_.cause = "nothing to cancel";
  }
}

void GoalExecutor::pause(std::int64_t id, std::int64_t now) {
  now_ = now;
  report_.goal_id = id;
  if (is_active() && !is_paused()) {
    search_.interrupt();
    path_.stand_still(stops_, now_);
    enter(GoalPhase::kPaused, NavigationState::kPaused,
          fmt::format("paused on the way to {}", place_of(stops_.stop())));
  }
}

void GoalExecutor::resume(std::int64_t id, std::int64_t now) {
  now_ = now;
  report_.goal_id = id;
  if (!is_active()) {
    return;
  }
  // The path carries the id that the status carries, or the controller waits for another one.
  stops_.rename(id);
  path_.rename(id);
  if (is_paused()) {
    losses_.begin();
    enter(GoalPhase::kLocalizing, NavigationState::kLocalizing, "");
  }
}

void GoalExecutor::refuse(std::int64_t id, const std::string& why, std::int64_t now) {
  now_ = now;
  report_ = {};
  report_.goal_id = id;
  finish(NavigationState::kNoPath, why);
}

void GoalExecutor::set_zones(const std::vector<Zone>& zones) {
  map_.set_zones(zones);
  if (phase_ == GoalPhase::kFollowing || phase_ == GoalPhase::kHolding) {
    path_.stand_still(stops_, now_);
    last_plan_ = 0;
    plan_anew("other zones are in force");
  }
}

void GoalExecutor::enter(GoalPhase phase, NavigationState state, const std::string& cause) {
  assert(may_follow(phase_, phase));
  if (phase != phase_) {
    phase_since_ = now_;
  }
  phase_ = phase;
  report_.state = state;
  report_.cause = cause;
  cause_before_.reset();
}

void GoalExecutor::plan_anew(const std::string& cause) {
  enter(GoalPhase::kPlanning, NavigationState::kPlanning, cause);
}

void GoalExecutor::finish(NavigationState state, const std::string& cause) {
  path_.stand_still(stops_, now_);
  report_.distance_left = 0.0;
  report_.target.reset();
  enter(GoalPhase::kNone, state, cause);
}

void GoalExecutor::fail_stop(NavigationState state, const std::string& cause) {
  path_.stand_still(stops_, now_);
  map_.drop_suspects();
  switch (stops_.failed(state == NavigationState::kLost)) {
    case StopList::AfterFailure::kTryAgain:
      enter(GoalPhase::kRetrying, NavigationState::kWaiting,
            fmt::format("{}; trying again in {:.0f} s ({} of {})", cause, params_.retry_wait, stops_.retries(),
                        params_.retries));
      break;
    case StopList::AfterFailure::kGoOn:
      next_stop();
      break;
    case StopList::AfterFailure::kGiveUp:
      finish(state, cause);
      break;
  }
}

void GoalExecutor::reached_stop() {
  stops_.reached();
  path_.stand_still(stops_, now_);
  report_.distance_left = 0.0;
  if (stops_.stop().wait > 0.0) {
    enter(GoalPhase::kDwelling, NavigationState::kWaiting,
          fmt::format("staying at {} for {:.0f} s", place_of(stops_.stop()), stops_.stop().wait));
    return;
  }
  leave_stop();
}

void GoalExecutor::leave_stop() {
  if (!stops_.is_last()) {
    next_stop();
    return;
  }
  finish(NavigationState::kArrived,
         stops_.skipped() > 0 ? fmt::format("{} of {} stops were skipped", stops_.skipped(), stops_.count()) : "");
}

void GoalExecutor::next_stop() {
  stops_.next();
  reset_for_stop();
  plan_anew("");
}

void GoalExecutor::reset_for_stop() {
  report_.stop_index = stops_.index();
  report_.target = stops_.stop();
  map_.drop_suspects();
  losses_.reset();
  doubtful_start_.reset();
  progress_.reset();
  people_.reset();
  hold_.reset();
  gaps_.reset();
  search_.reset();
  last_plan_ = 0;
}

void GoalExecutor::restart_clock(std::int64_t now) {
  phase_since_ = now;
  last_plan_ = 0;
  map_.restart_clock(now);
  losses_.begin();
  doubtful_start_.begin_anew(now);
  progress_.restart_clock(now);
  people_.restart_clock();
  hold_.restart_clock(now);
}

void GoalExecutor::update(const Situation& situation) {
  if (situation.now < now_ - kClockJump) {  // nothing that was timed holds
    restart_clock(situation.now);
  }
  now_ = situation.now;
  people_.hear(situation);
  switch (phase_) {
    case GoalPhase::kNone:
    case GoalPhase::kPaused:
      return;
    case GoalPhase::kDwelling:
      if (seconds_of(now_ - phase_since_) >= stops_.stop().wait) {
        leave_stop();
      }
      return;
    case GoalPhase::kRetrying:
      if (seconds_of(now_ - phase_since_) >= params_.retry_wait) {
        progress_.reset();
        gaps_.reset();
        search_.reset();
        plan_anew("");
      }
      return;
    default:
      break;
  }
  if (is_localized(situation)) {
    update_at_place(situation);
  }
}

void GoalExecutor::update_at_place(const Situation& situation) {
  map_.expire_suspects(now_);
  if (map_.is_drawn_by_robot()) {
    search_.drive_to(situation.world_from_robot.position());
    if (search_.is_in_vain()) {
      fail_stop(NavigationState::kNoPath,
                fmt::format("no way to {} found in {:.0f} m of driving, {:.1f} m were expected",
                            place_of(stops_.stop()), search_.driven(), search_.first_length()));
      return;
    }
  }
  suspect_touched(situation);
  switch (phase_) {
    case GoalPhase::kPlanning:
    case GoalPhase::kSuspectingPlace:
      plan(situation);
      break;
    case GoalPhase::kFollowing:
      update_following(situation);
      break;
    case GoalPhase::kHolding:
      update_hold(situation);
      break;
    default:
      break;
  }
}

bool GoalExecutor::is_localized(const Situation& situation) {
  if (situation.tracking) {
    losses_.track(now_);
    if (cause_before_) {
      report_.cause = *std::exchange(cause_before_, std::nullopt);
    }
    return phase_ != GoalPhase::kLocalizing || found_place(situation);
  }
  if (phase_ == GoalPhase::kLocalizing) {
    search_place(situation);
  } else if (!losses_.is_brief(now_)) {
    lose_place(situation);
  } else {
    if (!cause_before_) {
      cause_before_ = report_.cause;
    }
    report_.cause = situation.localization;
  }
  return false;
}

bool GoalExecutor::found_place(const Situation& situation) {
  plan_anew("");
  last_plan_ = 0;
  progress_.forget_attempts();  // it has been elsewhere since; the number of losses bounds this
  if (losses_.has_lost() && stops_.is_at_stop(situation.world_from_robot)) {
    reached_stop();  // no need to drive off and lose the pose again
    return false;
  }
  return true;
}

void GoalExecutor::lose_place(const Situation& situation) {
  search_.interrupt();
  if (!losses_.count(report_.distance_left)) {
    fail_stop(NavigationState::kLost,
              fmt::format("lost its place {} times {:.1f} m before {}: {}", params_.losses, report_.distance_left,
                          place_of(stops_.stop()), situation.localization));
    return;
  }
  path_.stand_still(stops_, now_);
  enter(GoalPhase::kLocalizing, NavigationState::kLocalizing, situation.localization);
  search_place(situation);
}

void GoalExecutor::search_place(const Situation& situation) {
  report_.cause = situation.localization;
  if (!situation.can_move) {
    report_.cause = situation.cannot_move;
    phase_since_ = now_;  // a robot that may not move cannot search
  }
  if (seconds_of(now_ - phase_since_) > params_.lost_timeout) {
    fail_stop(NavigationState::kLost, fmt::format("gave up after searching for {:.0f} s: {}", params_.lost_timeout,
                                                  situation.localization.empty() ? "no pose" : situation.localization));
  }
}

}  // namespace luminav
