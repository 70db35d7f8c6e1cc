#include "services/planner/goal_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace luminav {
namespace {

constexpr double kSkipBesideRobot = 0.35;   // [m] of the path: what is that near is the controller's business
constexpr double kSearchAhead = 3.0;        // [m] of the path: forward only, so that crossing paths are not cut short
constexpr double kShortestHold = 0.4;       // [m] a way to a blockage shorter than that is not worth driving
constexpr double kHoldReached = 0.4;        // [m] from the end of that way
constexpr double kSlowestSpeed = 0.1;       // [m/s] that a way to a blockage may take
constexpr int kArrivalFailures = 3;         // the controller says "there" and the pose says "no"
constexpr double kSuspectAhead = 0.45;      // [m] on the path where something stopped the robot
constexpr double kArrivalError = 0.04;      // [m] the controller stops within this of a path's end
constexpr double kAttemptsForgotten = 1.0;  // [m] of progress after which attempts count from zero again

std::string place_of(const GoalStop& stop) {
  return stop.place.empty() ? fmt::format("({:.1f}, {:.1f})", stop.pose.x, stop.pose.y)
                            : fmt::format("{} ({:.1f}, {:.1f})", stop.place, stop.pose.x, stop.pose.y);
}

}  // namespace

GoalCycle::GoalCycle(const GoalCycleParams& params, const RoutePlannerParams& planner, std::vector<Door> doors)
    : params_(params), planner_params_(planner), planner_(planner), doors_(std::move(doors)) {}

// ---------------------------------------------------------------------------------------------------- requests

void GoalCycle::start(const GoalRequest& goal, std::int64_t now) {
  begin(goal, 0, now);
}

void GoalCycle::resume_at(const GoalRequest& goal, int stop_index, std::int64_t now) {
  begin(goal, std::clamp(stop_index, 0, static_cast<int>(goal.stops.size()) - 1), now);
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
  map_dirty_ = true;
  last_tracking_ = 0;
  last_plan_ = 0;
  attempts_ = losses_ = arrival_failures_ = retries_ = failures_in_a_row_ = skipped_ = 0;
  set_path({});
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
    paused_phase_ = phase_;
    set_path({});
    enter(Phase::kPaused, NavigationState::kPaused, fmt::format("paused on the way to {}", place_of(stop())));
  }
}

void GoalCycle::resume(std::int64_t id, std::int64_t now) {
  now_ = now;
  report_.goal_id = id;
  if (phase_ == Phase::kPaused) {
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
  attempts_ = losses_ = arrival_failures_ = retries_ = 0;
  suspects_.clear();
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
    if (phase_ == Phase::kLocalizing) {
      enter(Phase::kPlanning, NavigationState::kPlanning, "");
      last_plan_ = 0;
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
    phase_since_ = progress_since_ = situation.now;
    last_tracking_ = last_plan_ = hold_since_ = 0;
    for (Suspect& suspect : suspects_) {
      suspect.until = situation.now;
    }
  }
  now_ = situation.now;
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
  switch (phase_) {
    case Phase::kPlanning:
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

// ---------------------------------------------------------------------------------------------------- planning

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
  if (route.outcome == RouteOutcome::kFound) {
    follow(route);
  } else {
    handle_no_route(situation, route);
  }
}

std::string GoalCycle::no_path_sentence(const Route& route) const {
  const GridGeometry& geometry = planner_.space().geometry();
  const Eigen::Vector2d& goal = stop().pose.position();
  const std::string nearest =
      route.nearest_reachable
          ? fmt::format("nearest reachable point ({:.1f}, {:.1f}) is {:.2f} m away, tolerance {:.2f} m",
                        route.nearest_reachable->x(), route.nearest_reachable->y(),
                        (*route.nearest_reachable - goal).norm(), planned_tolerance())
          : "nothing is reachable from here";
  switch (route.outcome) {
    case RouteOutcome::kGoalOutside:
      return fmt::format("goal {} lies outside the map, which is {:.1f} to {:.1f} by {:.1f} to {:.1f} m",
                         place_of(stop()), geometry.origin.x(),
                         geometry.origin.x() + geometry.columns * geometry.resolution, geometry.origin.y(),
                         geometry.origin.y() + geometry.rows * geometry.resolution);
    case RouteOutcome::kStartOutside:
      return "the robot stands outside the map";
    case RouteOutcome::kGoalBlocked:
      return fmt::format("goal {} lies in or beside an obstacle: {}", place_of(stop()), nearest);
    default:
      return fmt::format("no way leads to {}: {}", place_of(stop()), nearest);
  }
}

void GoalCycle::handle_no_route(const Situation& situation, const Route& route) {
  if (!suspects_.empty()) {
    suspects_.clear();  // only suspected: better try again than give up for them
    map_dirty_ = true;
    enter(Phase::kPlanning, NavigationState::kPlanning, "");
    return;
  }
  if (route.outcome == RouteOutcome::kGoalOutside || route.outcome == RouteOutcome::kStartOutside) {
    fail_stop(NavigationState::kNoPath, no_path_sentence(route));
    return;
  }
  // is it the building, or something that may go away?
  RoutePlanner by_map(planner_params_);
  by_map.set_grid(*grid_, {}, false);
  const Route way = by_map.plan({situation.world_from_robot.position(), stop().pose.position(), planned_tolerance()});
  if (way.outcome != RouteOutcome::kFound) {
    fail_stop(NavigationState::kNoPath, no_path_sentence(route));
    return;
  }
  const auto beside = static_cast<std::size_t>(kSkipBesideRobot / planner_params_.shaping.spacing) + 1;
  const std::size_t blocked = planner_.first_blocked(way.points, beside).value_or(way.points.size() - 1);
  hold(situation, way.points, blocked, polyline_length(way.points));
  if (route.outcome == RouteOutcome::kGoalBlocked) {
    hold_reason_ = no_path_sentence(route);
    report_.cause = fmt::format("{}; waiting {:.0f} s", hold_reason_, params_.blocked_wait);
  }
}

void GoalCycle::follow(const Route& route) {
  set_path(route.points);
  progress_since_ = now_;
  progress_left_ = polyline_length(route.points);
  report_.distance_left = progress_left_;
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

// ---------------------------------------------------------------------------------------------------- blocked ways

void GoalCycle::hold(const Situation& situation, const Polyline& way, std::size_t blocked_at, double reference_length) {
  blockage_ = measure_blockage(planner_.space(), doors_, way, blocked_at, 2.0 * planner_params_.space.hard_radius);
  hold_reason_ = blockage_.sentence();
  reference_length_ = reference_length;
  Polyline approach(way.begin(), way.begin() + static_cast<std::ptrdiff_t>(blocked_at) + 1);
  const auto back = static_cast<std::size_t>(params_.hold_distance / planner_params_.shaping.spacing);
  approach.resize(approach.size() > back ? approach.size() - back : 0);
  const bool worth_driving = approach.size() >= 2 && polyline_length(approach) > kShortestHold;
  set_path(worth_driving ? approach : Polyline{});
  // no final heading, no tight tolerance: it only waits there
  path_.has_theta = false;
  path_.tolerance = 0.3;
  hold_since_ = worth_driving ? 0 : now_;
  phase_ = Phase::kNone;  // a new blockage has a time of its own
  enter(Phase::kHolding, NavigationState::kWaiting,
        fmt::format("{}; waiting {:.0f} s", hold_reason_, params_.blocked_wait));
  (void)situation;
}

void GoalCycle::update_hold(const Situation& situation) {
  if (!path_.points.empty()) {
    advance_along(situation.world_from_robot);
  }
  const bool there =
      path_.points.empty() || (path_.points.back() - situation.world_from_robot.position()).norm() < kHoldReached ||
      (situation.control && situation.control->at_goal && situation.control->path_sequence == path_.sequence);
  const double drive_time = params_.blocked_wait + polyline_length(path_.points) / kSlowestSpeed;
  if (hold_since_ == 0 && (there || seconds_since(phase_since_) > drive_time)) {
    hold_since_ = now_;
  }
  const bool waited = hold_since_ != 0 && seconds_since(hold_since_) >= params_.blocked_wait;
  if (!waited && (!map_dirty_ || seconds_since(last_plan_) < params_.replan_period)) {
    return;
  }
  const Route route = plan_route(situation);
  if (route.outcome != RouteOutcome::kFound) {
    if (hold_since_ != 0 && seconds_since(hold_since_) >= params_.give_up_wait) {
      const bool by_goal = route.outcome == RouteOutcome::kGoalBlocked;
      fail_stop(NavigationState::kBlocked,
                fmt::format("{}; waited {:.0f} s, no other way", by_goal ? no_path_sentence(route) : hold_reason_,
                            params_.give_up_wait));
    }
    return;
  }
  const double limit = params_.detour_ratio * reference_length_ + params_.detour_length;
  if (waited || polyline_length(route.points) <= limit) {
    ++report_.replans;
    follow(route);
  }
}

// ---------------------------------------------------------------------------------------------------- following

void GoalCycle::update_following(const Situation& situation) {
  advance_along(situation.world_from_robot);
  report_.distance_left = polyline_length(remaining(situation.world_from_robot));
  const bool yielding = situation.control && situation.control->yielding;
  report_.state = yielding ? NavigationState::kWaiting : NavigationState::kFollowing;
  report_.cause = !situation.can_move ? situation.cannot_move : yielding ? situation.control->reason : "";
  check_arrival(situation);
  if (phase_ == Phase::kFollowing) {
    check_path(situation);
  }
  if (phase_ == Phase::kFollowing) {
    check_progress(situation);
  }
}

double GoalCycle::planned_tolerance() const {
  return std::max(0.5 * tolerance(), tolerance() - kArrivalError);
}

bool GoalCycle::is_at_stop(const Pose2& pose) const {
  const bool near = (pose.position() - stop().pose.position()).norm() <= tolerance() + 1e-6;
  const bool turned =
      !stop().has_theta || std::abs(wrap_angle(pose.theta - stop().pose.theta)) <= heading_tolerance() + 1e-6;
  return near && turned;
}

void GoalCycle::check_arrival(const Situation& situation) {
  if (!situation.control || !situation.control->at_goal || situation.control->path_sequence != path_.sequence) {
    return;
  }
  if (is_at_stop(situation.world_from_robot)) {
    reached_stop();
    return;
  }
  const Pose2& pose = situation.world_from_robot;
  if (++arrival_failures_ > kArrivalFailures) {
    fail_stop(NavigationState::kStuck,
              fmt::format("stopped {:.2f} m from {}, tolerance {:.2f} m{}", distance(pose, stop().pose),
                          place_of(stop()), tolerance(),
                          stop().has_theta ? fmt::format(", heading {:.0f} degrees off",
                                                         degrees(std::abs(wrap_angle(pose.theta - stop().pose.theta))))
                                           : ""));
    return;
  }
  ++report_.replans;
  last_plan_ = 0;
  enter(Phase::kPlanning, NavigationState::kPlanning, "the pose was corrected at the goal");
}

void GoalCycle::check_path(const Situation& situation) {
  const Eigen::Vector2d robot = situation.world_from_robot.position();
  const bool off_path = (path_.points[at_] - robot).norm() > params_.off_path;
  if ((!map_dirty_ && !off_path) || seconds_since(last_plan_) < params_.replan_period) {
    return;
  }
  refresh_space();
  last_plan_ = now_;
  const Polyline left = remaining(situation.world_from_robot);
  std::size_t beside = 0;
  while (beside < left.size() && (left[beside] - robot).norm() < kSkipBesideRobot) {
    ++beside;
  }
  const std::optional<std::size_t> blocked = planner_.first_blocked(left, beside);
  const Route route = planner_.plan({robot, stop().pose.position(), planned_tolerance()});
  if (route.outcome != RouteOutcome::kFound) {
    if (blocked || off_path) {
      handle_no_route(situation, route);
    }
    return;  // the rest of the path is passable still: hold on to it
  }
  const bool better = route.cost < params_.keep_ratio * cost_of(planner_.space(), left);
  if (!blocked && !off_path && !better) {
    return;
  }
  const double limit = params_.detour_ratio * report_.distance_left + params_.detour_length;
  if (blocked && polyline_length(route.points) > limit) {
    hold(situation, left, *blocked, report_.distance_left);
    return;
  }
  ++report_.replans;
  const std::int64_t since = progress_since_;
  follow(route);
  progress_since_ = since;  // planning is no progress
}

void GoalCycle::check_progress(const Situation& situation) {
  if (!situation.can_move || report_.distance_left < progress_left_ - params_.progress_length) {
    progress_since_ = now_;
    progress_left_ = report_.distance_left;
    if (report_.distance_left < attempt_left_ - kAttemptsForgotten) {
      attempts_ = 0;
      attempt_left_ = report_.distance_left;
    }
    return;
  }
  const bool controller_stuck = situation.control && situation.control->stuck;
  const bool controller_moves =
      situation.control && situation.control->seconds_without_progress < params_.no_progress_time && !controller_stuck;
  const double patience = controller_stuck   ? 0.3 * params_.no_progress_time
                          : controller_moves ? 3.0 * params_.no_progress_time
                                             : params_.no_progress_time;
  if (seconds_since(progress_since_) < patience) {
    return;
  }
  if (is_at_stop(situation.world_from_robot)) {
    reached_stop();
    return;
  }
  if (++attempts_ == 1) {
    first_attempt_ = now_;
  }
  if (attempts_ > params_.attempts && seconds_since(first_attempt_) >= params_.stuck_time) {
    const std::string why = !situation.control                  ? "the controller is silent"
                            : situation.control->reason.empty() ? "the controller does not say why"
                                                                : situation.control->reason;
    fail_stop(NavigationState::kStuck,
              fmt::format("no progress at ({:.1f}, {:.1f}), {:.1f} m before {}, after {} plans: {}",
                          situation.world_from_robot.x, situation.world_from_robot.y, report_.distance_left,
                          place_of(stop()), attempts_ - 1, why));
    return;
  }
  if (attempts_ >= 2) {
    suspect_ahead(situation);
  }
  ++report_.replans;
  map_dirty_ = true;
  last_plan_ = 0;
  enter(Phase::kPlanning, NavigationState::kPlanning, "no progress: planning anew");
  plan(situation);
}

void GoalCycle::suspect_ahead(const Situation& situation) {
  const Eigen::Vector2d robot = situation.world_from_robot.position();
  for (std::size_t i = at_; i < path_.points.size(); ++i) {
    if ((path_.points[i] - robot).norm() >= kSuspectAhead) {
      SuspectedObstacle obstacle;
      obstacle.centre = path_.points[i];
      suspects_.push_back({obstacle, now_ + static_cast<std::int64_t>(params_.suspect_time * 1e6)});
      map_dirty_ = true;
      return;
    }
  }
}

// ---------------------------------------------------------------------------------------------------- the path

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

void GoalCycle::advance_along(const Pose2& pose) {
  double searched = 0.0;
  std::size_t best = at_;
  for (std::size_t i = at_; i < path_.points.size() && searched < kSearchAhead; ++i) {
    if ((path_.points[i] - pose.position()).squaredNorm() < (path_.points[best] - pose.position()).squaredNorm()) {
      best = i;
    }
    if (i + 1 < path_.points.size()) {
      searched += (path_.points[i + 1] - path_.points[i]).norm();
    }
  }
  at_ = best;
}

Polyline GoalCycle::remaining(const Pose2& pose) const {
  Polyline left = {pose.position()};
  const std::size_t next = std::min(at_ + 1, path_.points.size() - 1);
  left.insert(left.end(), path_.points.begin() + static_cast<std::ptrdiff_t>(next), path_.points.end());
  return left;
}

double GoalCycle::tolerance() const {
  return goal_.tolerance > 0.0 ? goal_.tolerance : params_.tolerance;
}

double GoalCycle::heading_tolerance() const {
  return goal_.heading_tolerance > 0.0 ? goal_.heading_tolerance : params_.heading_tolerance;
}

}  // namespace luminav
