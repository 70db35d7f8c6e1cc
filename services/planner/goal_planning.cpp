#include "services/planner/goal_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/planner/goal_sentences.hpp"

namespace luminav {
namespace {

constexpr double kShortestHold = 0.4;           // [m] a way to a blockage shorter than that is not worth driving
constexpr double kShortestLook = 0.15;          // [m] the same where looking at it is what it drives for
constexpr double kNearEnough = 0.5;             // [m] from it: nearer it would creep into what stands there
constexpr double kHoldReached = 0.4;            // [m] from the end of that way
constexpr double kSlowestSpeed = 0.1;           // [m/s] that a way to a blockage may take
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
  if (route.outcome == RouteOutcome::kStartOutside && doubt_place(situation)) {
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
  const Route way = by_map.plan({situation.world_from_robot.position(), stop().pose.position(), planned_tolerance()});
  if (way.outcome == RouteOutcome::kStartEnclosed && doubt_place(situation)) {
    return;
  }
  if (way.outcome != RouteOutcome::kFound) {
    fail_stop(NavigationState::kNoPath,
              no_path_sentence(route, planner_.space().geometry(), stop(), planned_tolerance()));
    return;
  }
  const auto beside = static_cast<std::size_t>(kSkipBesideRobot / planner_params_.shaping.spacing) + 1;
  const std::size_t blocked = planner_.first_blocked(way.points, beside).value_or(way.points.size() - 1);
  hold(way.points, blocked, polyline_length(way.points));
  if (route.outcome == RouteOutcome::kGoalBlocked) {
    hold_reason_ = no_path_sentence(route, planner_.space().geometry(), stop(), planned_tolerance());
    report_.cause = fmt::format("{}; waiting {:.0f} s", hold_reason_, params_.blocked_wait);
  }
}

bool GoalCycle::doubt_place(const Situation& situation) {
  const Pose2& robot = situation.world_from_robot;
  if (phase_ != Phase::kDoubting) {
    if (++doubts_ > params_.losses) {
      return false;
    }
    set_path({});
    looks_round_ = 0;
    enter(Phase::kDoubting, NavigationState::kWaiting,
          fmt::format("the map leaves a robot no room at ({:.1f}, {:.1f}), where it seems to be; looking round for "
                      "{:.0f} s",
                      robot.x, robot.y, params_.doubt_time));
  }
  if (!situation.can_move) {  // it cannot look round: somebody may be carrying it
    phase_since_ = now_;
    looks_round_ = 0;
    set_path({});
    return true;
  }
  const double doubted = seconds_since(phase_since_);
  if (doubted >= params_.doubt_still + looks_round_ * params_.doubt_turn) {
    ++looks_round_;
    set_path({robot.position()});
    path_.has_theta = true;
    path_.theta = wrap_angle(robot.theta + kLookRound);
    path_.tolerance = params_.hold_tolerance;
  }
  return doubted < params_.doubt_time;
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

void GoalCycle::hold(const Polyline& way, std::size_t blocked_at, double reference_length) {
  blockage_ = measure_blockage(planner_.space(), doors_, way, blocked_at, 2.0 * planner_params_.space.hard_radius);
  hold_reason_ = blockage_.sentence();
  reference_length_ = reference_length;
  search_.expect(reference_length);
  Polyline approach(way.begin(), way.begin() + static_cast<std::ptrdiff_t>(blocked_at) + 1);
  const bool is_drawn = planner_params_.space.unknown_is_free;  // by this robot alone: worth a look from near
  const double distance = is_drawn ? params_.gap_distance : params_.hold_distance;
  const auto back = static_cast<std::size_t>(distance / planner_params_.shaping.spacing);
  approach.resize(approach.size() > back ? approach.size() - back : 0);
  const bool is_near = is_drawn && (way[blocked_at] - way.front()).norm() < kNearEnough;
  const bool worth_driving =
      !is_near && approach.size() >= 2 && polyline_length(approach) > (is_drawn ? kShortestLook : kShortestHold);
  set_path(worth_driving ? approach : Polyline{});
  // no final heading, no tight tolerance: it only waits there
  path_.has_theta = is_drawn && worth_driving;
  path_.tolerance = is_drawn ? params_.gap_distance : params_.hold_tolerance;
  if (path_.has_theta) {
    const Eigen::Vector2d ahead = way[blocked_at] - approach.back();
    path_.theta = std::atan2(ahead.y(), ahead.x());
  }
  hold_since_ = worth_driving ? 0 : now_;
  blocked_way_ = way;
  last_facing_ = 0;
  has_looked_again_ = false;
  looks_at_gap_ = false;
  phase_ = Phase::kNone;  // a new blockage has a time of its own
  enter(Phase::kHolding, NavigationState::kWaiting,
        fmt::format("{}; waiting {:.0f} s", hold_reason_, params_.blocked_wait));
}

void GoalCycle::update_hold(const Situation& situation) {
  if (!path_.points.empty()) {
    at_ = nearest_ahead(path_.points, at_, situation.world_from_robot.position());
  }
  const bool there = path_.points.empty() ||
                     (path_.points.back() - situation.world_from_robot.position()).norm() < kHoldReached ||
                     is_at_end(situation);
  const double drive_time = params_.blocked_wait + polyline_length(path_.points) / kSlowestSpeed;
  if (hold_since_ == 0 && (there || seconds_since(phase_since_) > drive_time)) {
    hold_since_ = now_;
  }
  const double wait = looks_at_gap_ ? params_.gap_wait : params_.blocked_wait;
  const bool waited = hold_since_ != 0 && seconds_since(hold_since_) >= wait;
  if (!waited && (!map_dirty_ || seconds_since(last_plan_) < params_.replan_period)) {
    return;
  }
  const Route route = plan_route(situation);
  if (waited && looks_at_gap_) {  // it stayed shut, or opened: the next one
    if (!look_at_gap(situation, route)) {
      enter(Phase::kPlanning, NavigationState::kPlanning, "");
      plan(situation);
    }
    return;
  }
  if (route.outcome != RouteOutcome::kFound) {
    if (hold_since_ != 0 && seconds_since(hold_since_) >= params_.look_again && !has_looked_again_) {
      look_again(situation, route);
    }
    if (hold_since_ != 0 && seconds_since(hold_since_) >= params_.give_up_wait) {
      const bool by_goal = route.outcome == RouteOutcome::kGoalBlocked;
      fail_stop(NavigationState::kBlocked,
                fmt::format("{}; waited {:.0f} s, no other way",
                            by_goal ? no_path_sentence(route, planner_.space().geometry(), stop(), planned_tolerance())
                                    : hold_reason_,
                            params_.give_up_wait));
      return;
    }
    face_blockage(situation);
    return;
  }
  const double limit = params_.detour_ratio * reference_length_ + params_.detour_length;
  const bool is_long =
      looks_at_gap_ ? length_with_unknown(route.points) > gap_limit_ : polyline_length(route.points) > limit;
  if (waited || !is_long) {
    if (is_long) {
      suspect_blockage();
    }
    ++report_.replans;
    follow(route);
    return;
  }
  face_blockage(situation);
}

// Between two cones nothing is heard: evidence there would outlive whoever stood in the way.
void GoalCycle::face_blockage(const Situation& situation) {
  if (hold_since_ == 0 || seconds_since(hold_since_) < params_.facing_after || looks_at_gap_ ||
      (last_facing_ != 0 && seconds_since(last_facing_) < params_.facing_period)) {
    return;
  }
  const Pose2& robot = situation.world_from_robot;
  const Polyline way = rest_of(blocked_way_, nearest_ahead(blocked_way_, 0, robot.position()), robot.position());
  const std::optional<Eigen::Vector2d> place =
      what_blocks(planner_.space(), *grid_, way, planner_params_.space.hard_radius);
  if (!place) {
    return;
  }
  const Eigen::Vector2d towards = *place - robot.position();
  const double theta = std::atan2(towards.y(), towards.x());
  if (std::abs(wrap_angle(theta - robot.theta)) < params_.facing_angle) {
    return;
  }
  last_facing_ = now_;
  set_path({robot.position()});
  path_.has_theta = true;
  path_.theta = theta;
  path_.tolerance = params_.hold_tolerance;
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
  for (const double occupied : {params_.doubtful_log_odds, params_.sure_log_odds, params_.surest_log_odds}) {
    RoutePlannerParams doubting = planner_params_;
    doubting.space.hard_radius = planner_params_.body_radius;
    doubting.space.occupied_log_odds = occupied;
    RoutePlanner by_what_is_sure(doubting);
    by_what_is_sure.set_grid(*grid_, obstacles);
    const Route way = by_what_is_sure.plan({robot, stop().pose.position(), planned_tolerance()});
    if (way.outcome != RouteOutcome::kFound) {
      continue;
    }
    const double through = worth(length_with_unknown(way.points));  // of two, the one with less doubt if about as long
    const std::optional<std::size_t> blocked = planner_.first_blocked(way.points, beside);
    if (blocked && through < best_length) {
      best = way.points;
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

// Seen at a slant, a smooth thing and nothing at all look alike to a sonar: what lies in the way of the goal is looked
// at from another side, the nearest that can be reached, before it is taken for true.
void GoalCycle::look_again(const Situation& situation, const Route& route) {
  has_looked_again_ = true;
  if (route.outcome != RouteOutcome::kGoalBlocked || !route.nearest_reachable) {
    return;
  }
  const Route there =
      planner_.plan({situation.world_from_robot.position(), *route.nearest_reachable, params_.hold_tolerance});
  if (there.outcome != RouteOutcome::kFound || there.points.size() < 2) {
    return;
  }
  const Eigen::Vector2d way = stop().pose.position() - *route.nearest_reachable;
  set_path(there.points);
  path_.has_theta = true;
  path_.theta = std::atan2(way.y(), way.x());
  path_.tolerance = params_.hold_tolerance;
  hold_since_ = 0;
  phase_since_ = now_;
  report_.cause = fmt::format("{}; looking at it from there", hold_reason_);
}

// Sonar evidence fades or gets patchy while the robot goes the long way round: it would turn back half-way, again and
// again. For this goal it stands by what it saw.
void GoalCycle::suspect_blockage() {
  const ConfigurationSpace& space = planner_.space();
  const Cell centre = space.geometry().cell_at(blockage_.place);
  const int reach = static_cast<int>(params_.detour_radius / space.geometry().resolution);
  for (int row = centre.row - reach; row <= centre.row + reach; ++row) {
    for (int column = centre.column - reach; column <= centre.column + reach; ++column) {
      const Cell cell{column, row};
      const Eigen::Vector2d place = space.geometry().centre_of(cell);
      if (space.geometry().contains(cell) && (place - blockage_.place).norm() <= params_.detour_radius &&
          space.is_solid(cell) && grid_->prior[grid_->geometry.index(cell)] == Prior::kFree) {
        suspect({place, 0.5 * space.geometry().resolution}, params_.detour_memory);
      }
    }
  }
}

}  // namespace luminav
