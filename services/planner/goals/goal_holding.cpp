#include "services/planner/goals/goal_cycle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/planner/goals/goal_sentences.hpp"
#include "services/planner/goals/waiting_place.hpp"

namespace luminav {
namespace {

constexpr double kShortestHold = 0.4;      // [m] a way to a blockage shorter than that is not worth driving
constexpr double kShortestLook = 0.15;     // [m] the same where looking at it is what it drives for
constexpr double kNearEnough = 0.5;        // [m] from it: nearer it would creep into what stands there
constexpr double kHoldReached = 0.4;       // [m] from the end of that way
constexpr double kSlowestSpeed = 0.1;      // [m/s] that a way to a blockage may take
constexpr double kDetour = 3.0;            // [m] more than to the blockage that a place beside a door may be away
constexpr double kFacing = radians(15.0);  // [rad] off it, what is in the door is seen
constexpr std::size_t kPlacesTried = 4;    // beside a door
constexpr double kWantsToPass = 0.9;       // [m] from where it holds

}  // namespace

// Where the robot waits for a way that is blocked, and what ends the waiting.

void GoalCycle::hold(const Polyline& path, std::size_t blocked_at, double reference_length) {
  blockage_ = measure_blockage(planner_.space(), doors_, path, blocked_at, 2.0 * planner_params_.space.hard_radius);
  hold_reason_ = blockage_.sentence();
  reference_length_ = reference_length;
  search_.expect(reference_length);
  Polyline approach(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(blocked_at) + 1);
  const bool is_drawn = planner_params_.space.unknown_is_free;  // by this robot alone: worth a look from near
  const double distance = is_drawn ? params_.gap_distance : params_.hold_distance;
  const auto back = static_cast<std::size_t>(distance / planner_params_.shaping.spacing);
  approach.resize(approach.size() > back ? approach.size() - back : 0);
  const bool is_near = is_drawn && (path[blocked_at] - path.front()).norm() < kNearEnough;
  const bool worth_driving =
      !is_near && approach.size() >= 2 && polyline_length(approach) > (is_drawn ? kShortestLook : kShortestHold);
  set_path(worth_driving ? approach : Polyline{});
  // no final heading, no tight tolerance: it only waits there
  path_.has_theta = is_drawn && worth_driving;
  path_.tolerance = is_drawn ? params_.gap_distance : params_.hold_tolerance;
  if (path_.has_theta) {
    const Eigen::Vector2d ahead = path[blocked_at] - approach.back();
    path_.theta = std::atan2(ahead.y(), ahead.x());
  }
  hold_since_ = worth_driving ? 0 : now_;
  hold_place_ = worth_driving ? approach.back() : path.front();
  blocked_path_ = path;
  last_facing_ = 0;
  has_looked_again_ = false;
  looks_at_gap_ = false;
  phase_ = Phase::kNone;  // a new blockage has a time of its own
  enter(Phase::kHolding, NavigationState::kWaiting,
        fmt::format("{}; waiting {:.0f} s", hold_reason_, params_.blocked_wait));
  blocker_distance_ = distance_of_what_blocks();
  const Door* door = blocking_door();
  if (door != nullptr && is_in_opening(*door, hold_place_)) {
    wait_beside(*door, path);
  }
}

const Door* GoalCycle::blocking_door() const {
  const auto door =
      std::find_if(doors_.begin(), doors_.end(), [&](const Door& each) { return is_in_doorway(each, hold_place_); });
  const bool is_drawn = planner_params_.space.unknown_is_free;  // doors and walls alike are what it looks at
  return door != doors_.end() && !is_drawn && waits_beside_ < params_.waits_beside ? &*door : nullptr;
}

double GoalCycle::distance_of_what_blocks() const {
  const Polyline path = rest_of(blocked_path_, nearest_ahead(blocked_path_, 0, hold_place_), hold_place_);
  const std::optional<Eigen::Vector2d> place =
      what_blocks(planner_.space(), *grid_, path, planner_params_.space.hard_radius);
  return place ? (*place - hold_place_).norm() : std::numeric_limits<double>::infinity();
}

bool GoalCycle::wait_beside(const Door& door, const Polyline& path) {
  const double longest = kDetour + polyline_length(path);
  std::vector<Eigen::Vector2d> places = places_beside(door, path, planner_.space());
  places.resize(std::min(places.size(), kPlacesTried));
  for (const Eigen::Vector2d& place : places) {
    const Route there = planner_.plan({path.front(), place, 0.0});
    if (there.outcome == RouteOutcome::kFound && polyline_length(there.points) < longest) {
      const Eigen::Vector2d ahead = door.world_from_door.position() - place;
      set_path_to_wait(there.points, std::atan2(ahead.y(), ahead.x()));
      path_.heading_tolerance = kFacing;
      hold_place_ = place;
      hold_since_ = 0;
      phase_since_ = now_;
      ++waits_beside_;
      return true;
    }
  }
  return false;
}

// A thing stays where it is; who comes nearer wants to get out.
void GoalCycle::make_way(const Situation& situation) {
  const Door* door = blocking_door();
  if (door == nullptr || distance_of_what_blocks() > std::min(kWantsToPass, blocker_distance_ - params_.come_nearer)) {
    return;
  }
  Polyline path = blocked_path_;
  path.front() = situation.world_from_robot.position();
  if (wait_beside(*door, path)) {
    report_.cause = fmt::format("{}; making way", hold_reason_);
  }
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
    keep_holding(situation, route);
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

void GoalCycle::keep_holding(const Situation& situation, const Route& route) {
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
  make_way(situation);
  face_blockage(situation);
}

// Between two cones nothing is heard: evidence there would outlive whoever stood in the way.
void GoalCycle::face_blockage(const Situation& situation) {
  if (hold_since_ == 0 || seconds_since(hold_since_) < params_.facing_after || looks_at_gap_ ||
      (last_facing_ != 0 && seconds_since(last_facing_) < params_.facing_period)) {
    return;
  }
  const Pose2& robot = situation.world_from_robot;
  const Polyline path = rest_of(blocked_path_, nearest_ahead(blocked_path_, 0, robot.position()), robot.position());
  const std::optional<Eigen::Vector2d> place =
      what_blocks(planner_.space(), *grid_, path, planner_params_.space.hard_radius);
  if (!place) {
    return;
  }
  const Eigen::Vector2d towards = *place - robot.position();
  const double theta = std::atan2(towards.y(), towards.x());
  if (std::abs(wrap_angle(theta - robot.theta)) < params_.facing_angle) {
    return;
  }
  last_facing_ = now_;
  set_path_to_wait({robot.position()}, theta);
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
  const Eigen::Vector2d offset = stop().pose.position() - *route.nearest_reachable;
  set_path_to_wait(there.points, std::atan2(offset.y(), offset.x()));
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
