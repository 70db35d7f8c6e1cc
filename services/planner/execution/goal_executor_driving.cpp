// The phases in which the executor knows where the robot is: planning, following, holding.

#include <fmt/format.h>

#include <algorithm>

#include "services/common/geometry/seconds.hpp"
#include "services/planner/execution/goal_executor.hpp"
#include "services/planner/goals/goal_sentences.hpp"

namespace luminav {
namespace {

constexpr double kKeepRatio = 0.85;      // a new path replaces a passable one if it costs less than this share of it
constexpr double kOffPath = 0.6;         // [m] from the path before it is planned anew
constexpr double kMinTolerance = 0.05;   // [m] at the end of a path beside a blocked goal
constexpr double kSuspectAhead = 0.45;   // [m] on the path where something stopped the robot,
constexpr double kSuspectTime = 60.0;    // [s] that it is suspected there
constexpr double kTouchTime = 180.0;     // [s] that what the robot drove against is suspected there
constexpr double kPeopleAhead = 1.3;     // [m] on the path: the middle of where people are who do not let it pass,
constexpr double kPeopleRadius = 0.9;    // [m] with which they fill a corridor of 2.4 m and leave the robot its place
constexpr double kDetourMemory = 300.0;  // [s] on a detour, what was seen at the blockage counts as standing there

}  // namespace

RouteRequest GoalExecutor::request_from(const Situation& situation) const {
  return {situation.world_from_robot.position(), stops_.stop().pose.position(), stops_.planned_tolerance()};
}

bool GoalExecutor::may_plan() const {
  return last_plan_ == 0 || seconds_of(now_ - last_plan_) >= params_.replan_period;
}

Route GoalExecutor::plan_route(const Situation& situation) {
  map_.refresh();
  last_plan_ = now_;
  return map_.plan(request_from(situation));
}

std::string GoalExecutor::no_path(const Route& route) const {
  return no_path_sentence(route, map_.space().geometry(), stops_.stop(), stops_.planned_tolerance());
}

void GoalExecutor::plan(const Situation& situation) {
  if (!map_.is_complete()) {
    wait_for_map();
    return;
  }
  if (!may_plan()) {
    return;
  }
  const Route route = plan_route(situation);
  if (look_at_gap(situation, route)) {
    return;
  }
  if (route.outcome != RouteOutcome::kFound) {
    handle_no_route(situation, route);
    return;
  }
  follow(route);
  progress_.begin_path(report_.distance_left, now_);
}

void GoalExecutor::wait_for_map() {
  report_.cause = fmt::format("waiting for the map: {} of {} tiles", map_.received(), map_.tiles());
  if (seconds_of(now_ - phase_since_) > params_.map_timeout) {
    fail_stop(NavigationState::kNoPath,
              fmt::format("no complete map after {:.0f} s: {} of {} tiles; does the mapper run?", params_.map_timeout,
                          map_.received(), map_.tiles()));
  }
}

void GoalExecutor::handle_no_route(const Situation& situation, const Route& route) {
  if (!map_.suspects().empty()) {
    map_.drop_suspects();  // only suspected: better try again than give up for them
    plan_anew("");
    return;
  }
  if (route.outcome == RouteOutcome::kStartOutside && suspect_place(situation)) {
    return;
  }
  if (route.outcome == RouteOutcome::kGoalOutside || route.outcome == RouteOutcome::kStartOutside) {
    fail_stop(NavigationState::kNoPath, no_path(route));
    return;
  }
  // is it the building, or something that may go away?
  const Route by_building = map_.plan_by_building(request_from(situation));
  if (by_building.outcome == RouteOutcome::kStartEnclosed && suspect_place(situation)) {
    return;
  }
  if (by_building.outcome != RouteOutcome::kFound) {
    const std::string zones = map_.zones_in_the_way(request_from(situation));
    fail_stop(NavigationState::kNoPath, no_path(route) + (zones.empty() ? "" : "; in the way: " + zones));
    return;
  }
  const Polyline& path = by_building.points;
  hold(path, map_.first_blocked(path).value_or(path.size() - 1), polyline_length(path));
  if (route.outcome == RouteOutcome::kGoalBlocked) {
    hold_.set_reason(no_path(route));
    report_.cause = fmt::format("{}; waiting {:.0f} s", hold_.reason(), params_.blocked_wait);
  }
}

bool GoalExecutor::suspect_place(const Situation& situation) {
  const Pose2& robot = situation.world_from_robot;
  if (phase_ != GoalPhase::kSuspectingPlace) {
    if (!doubtful_start_.begin(now_)) {
      return false;
    }
    path_.stand_still(stops_, now_);
    enter(GoalPhase::kSuspectingPlace, NavigationState::kWaiting,
          fmt::format("the map leaves a robot no room at ({:.1f}, {:.1f}), where it seems to be; looking round for "
                      "{:.0f} s",
                      robot.x, robot.y, DoubtfulStart::kTime));
  }
  if (!situation.can_move) {  // it cannot look round: somebody may be carrying it
    doubtful_start_.begin_anew(now_);
    path_.stand_still(stops_, now_);
    return true;
  }
  if (const std::optional<PathOrder> turn = doubtful_start_.look_round(robot, now_)) {
    issue(*turn);
  }
  return !doubtful_start_.is_over(now_);
}

bool GoalExecutor::look_at_gap(const Situation& situation, const Route& route) {
  const std::optional<Gap> gap = gaps_.choose(map_, request_from(situation), route);
  if (!gap) {
    return false;
  }
  hold(gap->path, gap->blocked_at, polyline_length(gap->path));
  hold_.look_at_gap();
  report_.cause = fmt::format("{}; looking at it from near", hold_.reason());
  return true;
}

void GoalExecutor::follow(const Route& route) {
  PathOrder order = path_to_stop(route.points, stops_.stop());
  order.tolerance = std::max(kMinTolerance, stops_.tolerance() - route.goal_gap);
  issue(order);
  report_.distance_left = polyline_length(route.points);
  search_.expect(report_.distance_left);
  enter(GoalPhase::kFollowing, NavigationState::kFollowing,
        route.goal_gap > 0.01
            ? fmt::format("goal {} is blocked; driving to {:.2f} m beside it", place_of(stops_.stop()), route.goal_gap)
            : "");
}

void GoalExecutor::hold(const Polyline& path, std::size_t blocked_at, double reference_length) {
  search_.expect(reference_length);
  issue(hold_.begin(map_, path, blocked_at, reference_length, now_));
  enter(GoalPhase::kHolding, NavigationState::kWaiting,
        fmt::format("{}; waiting {:.0f} s", hold_.reason(), params_.blocked_wait));
  if (const std::optional<PathOrder> beside = hold_.leave_opening(map_, now_)) {
    issue(*beside);
  }
}

void GoalExecutor::update_hold(const Situation& situation) {
  path_.advance(situation.world_from_robot.position());
  hold_.update(path_, situation);
  const bool has_waited = hold_.has_waited(now_);
  if (!has_waited && (!map_.has_changed() || !may_plan())) {
    return;
  }
  const Route route = plan_route(situation);
  if (has_waited && hold_.is_look()) {  // it stayed shut, or opened: the next one
    if (!look_at_gap(situation, route)) {
      plan_anew("");
      plan(situation);
    }
    return;
  }
  if (route.outcome != RouteOutcome::kFound) {
    keep_holding(situation, route);
    return;
  }
  const bool is_long =
      hold_.is_look() ? gaps_.is_long(map_, route.points) : hold_.is_long(polyline_length(route.points));
  if (is_long && !has_waited) {
    if (const std::optional<PathOrder> turn = hold_.face_blockage(map_, situation.world_from_robot, now_)) {
      issue(*turn);
    }
    return;
  }
  if (is_long) {
    for (const SuspectedObstacle& obstacle : hold_.evidence(map_)) {
      suspect(obstacle, kDetourMemory);
    }
  }
  ++report_.replans;
  follow(route);
  progress_.begin_path(report_.distance_left, now_);
}

void GoalExecutor::keep_holding(const Situation& situation, const Route& route) {
  const Pose2& robot = situation.world_from_robot;
  if (const std::optional<PathOrder> there = hold_.look_again(map_, request_from(situation), route, now_)) {
    issue(*there);
    report_.cause = fmt::format("{}; looking at it from there", hold_.reason());
  }
  if (hold_.has_waited_in_vain(now_)) {
    const std::string& why = route.outcome == RouteOutcome::kGoalBlocked ? no_path(route) : hold_.reason();
    fail_stop(NavigationState::kBlocked, fmt::format("{}; waited {:.0f} s, no other way", why, params_.give_up_wait));
    return;
  }
  if (const std::optional<PathOrder> beside = hold_.make_way(map_, robot, now_)) {
    issue(*beside);
    report_.cause = fmt::format("{}; making way", hold_.reason());
  }
  if (const std::optional<PathOrder> turn = hold_.face_blockage(map_, robot, now_)) {
    issue(*turn);
  }
}

void GoalExecutor::update_following(const Situation& situation) {
  const Eigen::Vector2d robot = situation.world_from_robot.position();
  path_.advance(robot);
  report_.distance_left = polyline_length(path_.remaining(robot));
  const std::optional<std::string> waits = people_.cause(situation);
  report_.state = waits ? NavigationState::kWaiting : NavigationState::kFollowing;
  const Zone* const zone = find_zone(map_.params().space.zones, ZoneKind::kKeepOut, robot);
  const std::string leaves =
      zone == nullptr
          ? ""
          : fmt::format("inside the keep-out zone {}{}: driving out by the shortest way", zone->name, until_of(*zone));
  report_.cause = !situation.can_move ? situation.cannot_move : waits.value_or(leaves);
  check_arrival(situation);
  if (phase_ == GoalPhase::kFollowing) {
    check_path(situation);
  }
  if (phase_ == GoalPhase::kFollowing) {
    check_progress(situation);
  }
}

void GoalExecutor::check_arrival(const Situation& situation) {
  const Pose2& robot = situation.world_from_robot;
  if (!path_.is_finished(situation)) {
    return;
  }
  if (stops_.is_at_stop(robot)) {
    reached_stop();
    return;
  }
  if (!progress_.count_missed()) {
    fail_stop(NavigationState::kStuck, missed_sentence(robot, stops_.stop(), stops_.tolerance()));
    return;
  }
  ++report_.replans;
  last_plan_ = 0;
  plan_anew("the pose was corrected at the goal");
}

void GoalExecutor::check_path(const Situation& situation) {
  const Eigen::Vector2d robot = situation.world_from_robot.position();
  const bool is_off_path = path_.distance_to(robot) > kOffPath;
  if ((!map_.has_changed() && !is_off_path) || !may_plan()) {
    return;
  }
  const Route route = plan_route(situation);
  const Polyline left = path_.remaining(robot);
  const std::optional<std::size_t> blocked = map_.first_blocked_of_rest(left);
  if (blocked && look_at_gap(situation, route)) {
    return;
  }
  if (route.outcome != RouteOutcome::kFound) {
    if (blocked || is_off_path) {
      handle_no_route(situation, route);
    }
    return;  // the rest of the path is passable still: hold on to it
  }
  if (!blocked && !is_off_path && route.cost >= kKeepRatio * cost_of(map_.space(), left)) {
    return;
  }
  const double limit = params_.detour_ratio * report_.distance_left + params_.detour_length;
  if (blocked && polyline_length(route.points) > limit) {
    hold(left, *blocked, report_.distance_left);
    return;
  }
  ++report_.replans;
  follow(route);
  progress_.replace_path(report_.distance_left);
}

void GoalExecutor::check_progress(const Situation& situation) {
  if (!progress_.has_stalled(report_.distance_left, situation)) {
    return;
  }
  const Pose2& robot = situation.world_from_robot;
  if (stops_.is_at_stop(robot)) {
    reached_stop();
    return;
  }
  progress_.count_attempt(now_);
  if (progress_.is_stuck(people_.were_met_lately(now_), now_)) {
    fail_stop(NavigationState::kStuck,
              fmt::format("no progress at ({:.1f}, {:.1f}), {:.1f} m before {}, after {} plans: {}", robot.x, robot.y,
                          report_.distance_left, place_of(stops_.stop()), progress_.attempts() - 1,
                          what_controller_says(situation)));
    return;
  }
  suspect_what_stops(situation);
  ++report_.replans;
  last_plan_ = 0;
  plan_anew("no progress: planning anew");
  plan(situation);
}

// Who has met the same people for a minute leaves them the corridor and takes another path, if there is one; where
// there is none, what is only suspected is dropped again.
void GoalExecutor::suspect_what_stops(const Situation& situation) {
  const Eigen::Vector2d robot = situation.world_from_robot.position();
  if (!people_.were_met_lately(now_)) {
    const std::optional<Eigen::Vector2d> ahead = path_.point_ahead(robot, kSuspectAhead);
    if (ahead && progress_.attempts() >= 2) {
      suspect({.centre = *ahead}, kSuspectTime);
    }
    return;
  }
  if (!progress_.has_tried_long(now_) || !people_.may_be_left()) {
    return;
  }
  if (const std::optional<Eigen::Vector2d> ahead = path_.point_ahead(robot, kPeopleAhead)) {
    suspect({*ahead, kPeopleRadius}, kDetourMemory);
    progress_.forget_attempts();
  }
}

// Driven against something that no sonar hears, the robot must not come back to it by the same path.
void GoalExecutor::suspect_touched(const Situation& situation) {
  if (situation.has_touched && phase_ == GoalPhase::kFollowing) {
    suspect({.centre = situation.world_from_robot * Eigen::Vector2d(params_.touch_ahead, 0.0)}, kTouchTime);
  }
}

void GoalExecutor::suspect(const SuspectedObstacle& obstacle, double seconds) {
  map_.suspect(obstacle, now_ + microseconds_of(seconds));
}

}  // namespace luminav
