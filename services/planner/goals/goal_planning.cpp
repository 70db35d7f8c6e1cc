#include "services/planner/goals/goal_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/planner/goals/goal_sentences.hpp"

namespace luminav {
namespace {

constexpr double kLookRound = 2.0 * kPi / 3.0;  // [rad] turned at a time; less than half a turn, so that it goes on
constexpr double kGapRadius = 0.25;             // [m] round a gap that is not looked at twice
constexpr double kArrivalError = 0.04;          // [m] the controller stops within this of a path's end

}  // namespace

// What becomes of a plan: a way to follow, a blockage to wait before, or a refusal.

void GoalCycle::refresh_space() {
  if (!map_dirty_) {
    return;
  }
  std::vector<SuspectedObstacle> obstacles;
  for (const Suspect& suspect : suspects_) {
    obstacles.push_back(suspect.obstacle);
  }
  planner_.set_grid(*grid_, obstacles);
  map_dirty_ = false;
}

Route GoalCycle::plan_route(const Situation& situation) {
  refresh_space();
  last_plan_ = now_;
  return planner_.plan({situation.world_from_robot.position(), stop().pose.position(), planned_tolerance()});
}

void GoalCycle::plan(const Situation& situation) {
  if (grid_ == nullptr || tiles_received_ < tiles_) {
    report_.cause = fmt::format("waiting for the map: {} of {} tiles", tiles_received_, tiles_);
    if (seconds_since(phase_since_) > params_.map_timeout) {
      fail_stop(NavigationState::kNoPath,
                fmt::format("no complete map after {:.0f} s: {} of {} tiles; does the mapper run?", params_.map_timeout,
                            tiles_received_, tiles_));
    }
    return;
  }
  if (last_plan_ != 0 && seconds_since(last_plan_) < params_.replan_period) {
    return;
  }
  const Route route = plan_route(situation);
  if (look_at_gap(situation, route)) {
    return;
  }
  if (route.outcome == RouteOutcome::kFound) {
    follow(route);
  } else {
    handle_no_route(situation, route);
  }
}

void GoalCycle::handle_no_route(const Situation& situation, const Route& route) {
  if (!suspects_.empty()) {
    suspects_.clear();  // only suspected: better try again than give up for them
    map_dirty_ = true;
    enter(Phase::kPlanning, NavigationState::kPlanning, "");
    return;
  }
  if (route.outcome == RouteOutcome::kStartOutside && suspect_place(situation)) {
    return;
  }
  if (route.outcome == RouteOutcome::kGoalOutside || route.outcome == RouteOutcome::kStartOutside) {
    fail_stop(NavigationState::kNoPath,
              no_path_sentence(route, planner_.space().geometry(), stop(), planned_tolerance()));
    return;
  }
  // is it the building, or something that may go away?
  RoutePlanner by_map(planner_params_);
  by_map.set_grid(*grid_, {}, false);
  const Route detour =
      by_map.plan({situation.world_from_robot.position(), stop().pose.position(), planned_tolerance()});
  if (detour.outcome == RouteOutcome::kStartEnclosed && suspect_place(situation)) {
    return;
  }
  if (detour.outcome != RouteOutcome::kFound) {
    fail_stop(NavigationState::kNoPath,
              no_path_sentence(route, planner_.space().geometry(), stop(), planned_tolerance()));
    return;
  }
  const auto beside = static_cast<std::size_t>(kSkipBesideRobot / planner_params_.shaping.spacing) + 1;
  const std::size_t blocked = planner_.first_blocked(detour.points, beside).value_or(detour.points.size() - 1);
  hold(detour.points, blocked, polyline_length(detour.points));
  if (route.outcome == RouteOutcome::kGoalBlocked) {
    hold_reason_ = no_path_sentence(route, planner_.space().geometry(), stop(), planned_tolerance());
    report_.cause = fmt::format("{}; waiting {:.0f} s", hold_reason_, params_.blocked_wait);
  }
}

bool GoalCycle::suspect_place(const Situation& situation) {
  const Pose2& robot = situation.world_from_robot;
  if (phase_ != Phase::kSuspectingPlace) {
    if (++suspicions_ > params_.losses) {
      return false;
    }
    set_path({});
    looks_round_ = 0;
    enter(Phase::kSuspectingPlace, NavigationState::kWaiting,
          fmt::format("the map leaves a robot no room at ({:.1f}, {:.1f}), where it seems to be; looking round for "
                      "{:.0f} s",
                      robot.x, robot.y, params_.suspect_place_time));
  }
  if (!situation.can_move) {  // it cannot look round: somebody may be carrying it
    phase_since_ = now_;
    looks_round_ = 0;
    set_path({});
    return true;
  }
  const double suspected = seconds_since(phase_since_);
  if (suspected >= params_.suspect_place_still + looks_round_ * params_.suspect_place_turn) {
    ++looks_round_;
    set_path_to_wait({robot.position()}, wrap_angle(robot.theta + kLookRound));
  }
  return suspected < params_.suspect_place_time;
}

void GoalCycle::follow(const Route& route) {
  set_path(route.points);
  progress_since_ = now_;
  progress_left_ = polyline_length(route.points);
  report_.distance_left = progress_left_;
  search_.expect(progress_left_);
  if (attempts_ == 0) {
    attempt_left_ = progress_left_;
  }
  const double slack = tolerance() - route.goal_gap;
  path_.tolerance = std::max(0.05, slack);
  enter(Phase::kFollowing, NavigationState::kFollowing,
        route.goal_gap > 0.01
            ? fmt::format("goal {} is blocked; driving to {:.2f} m beside it", place_of(stop()), route.goal_gap)
            : "");
}

double GoalCycle::planned_tolerance() const {
  return std::max(0.5 * tolerance(), tolerance() - kArrivalError);
}

// Far, oblique echoes draw wide arcs from door posts, so that doors look narrow or shut on the robot's own map until it
// has looked at them from near.
bool GoalCycle::look_at_gap(const Situation& situation, const Route& route) {
  const bool is_found = route.outcome == RouteOutcome::kFound;
  if (!is_found && !suspects_.empty()) {
    return false;  // no sonar draws what is only suspected: it is dropped before anything is looked at
  }
  if (!planner_params_.space.unknown_is_free || static_cast<int>(search_.looked_at.size()) >= params_.gap_looks ||
      (!is_found && route.outcome != RouteOutcome::kUnreachable && route.outcome != RouteOutcome::kGoalBlocked)) {
    return false;
  }
  const Eigen::Vector2d robot = situation.world_from_robot.position();
  const auto worth = [&](double through) { return params_.gap_ratio * through + params_.gap_detour; };
  const double length = is_found ? length_with_unknown(route.points) : std::numeric_limits<double>::infinity();
  if (length < worth((stop().pose.position() - robot).norm())) {
    return false;
  }
  const auto beside = static_cast<std::size_t>(kSkipBesideRobot / planner_params_.shaping.spacing) + 1;
  std::vector<SuspectedObstacle> obstacles = search_.looked_at;
  for (const Suspect& suspect : suspects_) {
    obstacles.push_back(suspect.obstacle);
  }
  Polyline best;
  double best_length = length;
  std::size_t best_blocked = 0;
  for (const double occupied : {params_.suspect_log_odds, params_.sure_log_odds, params_.surest_log_odds}) {
    RoutePlannerParams sceptical = planner_params_;
    sceptical.space.hard_radius = planner_params_.body_radius;
    sceptical.space.occupied_log_odds = occupied;
    RoutePlanner by_what_is_sure(sceptical);
    by_what_is_sure.set_grid(*grid_, obstacles);
    const Route detour = by_what_is_sure.plan({robot, stop().pose.position(), planned_tolerance()});
    if (detour.outcome != RouteOutcome::kFound) {
      continue;
    }
    const double through =
        worth(length_with_unknown(detour.points));  // of two, the one with less doubt if about as long
    const std::optional<std::size_t> blocked = planner_.first_blocked(detour.points, beside);
    if (blocked && through < best_length) {
      best = detour.points;
      best_length = through;
      best_blocked = *blocked;
    }
  }
  if (best.empty()) {
    if (is_found || search_.has_looked_twice || search_.looked_at.empty()) {
      return false;
    }
    search_.has_looked_twice = true;  // from elsewhere they may look otherwise
    search_.looked_at.clear();
    return look_at_gap(situation, route);
  }
  hold(best, best_blocked, polyline_length(best));
  looks_at_gap_ = true;
  gap_limit_ = best_length;
  search_.looked_at.push_back({best[best_blocked], kGapRadius});
  report_.cause = fmt::format("{}; looking at it from near", hold_reason_);
  return true;
}

double GoalCycle::length_with_unknown(const Polyline& points) const {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double step = (points[i] - points[i - 1]).norm();
    const Cell cell = grid_->geometry.cell_at(points[i]);
    const std::size_t k = grid_->geometry.index(cell);
    const bool is_unknown =
        !grid_->geometry.contains(cell) || (grid_->prior[k] == Prior::kUnknown && grid_->evidence[k] == 0);
    length += is_unknown ? params_.unknown_ratio * step : step;
  }
  return length;
}

bool GoalCycle::searches_in_vain(const Situation& situation) {
  if (!planner_params_.space.unknown_is_free) {
    return false;
  }
  const Eigen::Vector2d robot = situation.world_from_robot.position();
  search_.driven += (robot - search_.last.value_or(robot)).norm();
  search_.last = robot;
  return search_.first_length > 0.0 &&
         search_.driven > params_.search_ratio * search_.first_length + params_.search_length;
}

}  // namespace luminav
