#include "services/planner/holding/blockage_hold.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "services/common/geometry/seconds.hpp"
#include "services/planner/goals/path_progress.hpp"
#include "services/planner/holding/waiting_place.hpp"

namespace luminav {
namespace {

constexpr double kHoldDistance = 0.8;   // [m] before a blockage where the robot waits,
constexpr double kHoldTolerance = 0.3;  // [m] for getting there
constexpr double kGapDistance = 0.25;   // [m] before a gap: from farther away its posts are all that is heard
constexpr double kGapWait = 4.0;        // [s] to look at it
constexpr double kMinHold = 0.4;        // [m] a path to a blockage shorter than that is not worth driving
constexpr double kMinLook = 0.15;       // [m] the same where looking at it is what it drives for
constexpr double kNearEnough = 0.5;     // [m] from it: nearer it would creep into what stands there
constexpr double kHoldReached = 0.4;    // [m] from the end of that path
constexpr double kMinSpeed = 0.1;       // [m/s] that a path to a blockage may take
constexpr double kLookAgain = 20.0;     // [s] after which a goal in an obstacle is looked at from as near as can be

constexpr double kWantsToPass = 0.9;     // [m] from where the robot waits
constexpr double kComeNearer = 0.2;      // [m] nearer than before: a thing stays where it is, who wants out does not
constexpr int kMaxWaitsBeside = 3;       // on the way to a stop
constexpr std::size_t kPlacesTried = 4;  // beside a door
constexpr double kDetour = 3.0;          // [m] more than to the blockage that a place beside a door may be away
constexpr double kBesideFacing = radians(15.0);  // [rad] off it, what is in the door is seen

constexpr double kFacingAfter = 10.0;  // [s] of waiting after which it looks whether what blocks it is still there,
constexpr double kFacingPeriod = 3.0;  // [s] between two turns for that
constexpr double kFacingAngle = 0.21;  // [rad] within which the robot faces it already: there the sonar cones overlap

constexpr double kEvidenceRadius = 1.5;  // [m] round the blockage

double heading_of(const Eigen::Vector2d& ahead) {
  return std::atan2(ahead.y(), ahead.x());
}

}  // namespace

BlockageHold::BlockageHold(const GoalParams& params, std::vector<Door> doors)
    : params_(params), doors_(std::move(doors)) {}

void BlockageHold::restart_clock(std::int64_t now) {
  sent_ = now;
  since_ = last_facing_ = 0;
}

PathOrder BlockageHold::begin(const RouteMap& map, const Polyline& path, std::size_t blocked_at,
                              double reference_length, std::int64_t now) {
  blockage_ = measure_blockage(map.space(), doors_, path, blocked_at, 2.0 * map.params().space.hard_radius);
  reason_ = blockage_.sentence();
  reference_length_ = reference_length;
  path_ = path;
  const bool is_drawn = map.is_drawn_by_robot();  // worth a look from near
  Polyline approach(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(blocked_at) + 1);
  const auto back = static_cast<std::size_t>((is_drawn ? kGapDistance : kHoldDistance) / map.params().shaping.spacing);
  approach.resize(approach.size() > back ? approach.size() - back : 0);
  const bool is_near = is_drawn && (path[blocked_at] - path.front()).norm() < kNearEnough;
  const bool is_worth_driving =
      !is_near && approach.size() >= 2 && polyline_length(approach) > (is_drawn ? kMinLook : kMinHold);
  PathOrder order;
  order.tolerance = is_drawn ? kGapDistance : kHoldTolerance;
  if (is_worth_driving) {
    order.points = approach;
  }
  if (is_worth_driving && is_drawn) {
    order.theta = heading_of(path[blocked_at] - approach.back());
  }
  sent_ = now;
  since_ = is_worth_driving ? 0 : now;
  place_ = is_worth_driving ? approach.back() : path.front();
  last_facing_ = 0;
  has_looked_again_ = is_look_ = false;
  blocker_distance_ = distance_of_what_blocks(map);
  return order;
}

std::optional<PathOrder> BlockageHold::leave_opening(RouteMap& map, std::int64_t now) {
  const Door* door = blocking_door(map);
  if (door == nullptr || !is_in_opening(*door, place_)) {
    return std::nullopt;
  }
  return wait_beside(map, *door, path_, now);
}

void BlockageHold::update(const IssuedPath& path, const Situation& situation) {
  const Polyline& points = path.points();
  const bool is_there = points.empty() ||
                        (points.back() - situation.world_from_robot.position()).norm() < kHoldReached ||
                        path.is_finished(situation);
  const double drive_time = params_.blocked_wait + polyline_length(points) / kMinSpeed;
  if (since_ == 0 && (is_there || seconds_of(situation.now - sent_) > drive_time)) {
    since_ = situation.now;
  }
}

double BlockageHold::seconds_waited(std::int64_t now) const {
  return since_ == 0 ? 0.0 : seconds_of(now - since_);
}

bool BlockageHold::has_waited(std::int64_t now) const {
  return since_ != 0 && seconds_waited(now) >= (is_look_ ? kGapWait : params_.blocked_wait);
}

bool BlockageHold::has_waited_in_vain(std::int64_t now) const {
  return since_ != 0 && seconds_waited(now) >= params_.give_up_wait;
}

bool BlockageHold::is_long(double length) const {
  return length > params_.detour_ratio * reference_length_ + params_.detour_length;
}

const Door* BlockageHold::blocking_door(const RouteMap& map) const {
  if (map.is_drawn_by_robot() || waits_beside_ >= kMaxWaitsBeside) {
    return nullptr;  // on a map that it draws itself, doors and walls alike are what it looks at
  }
  const auto door =
      std::find_if(doors_.begin(), doors_.end(), [&](const Door& each) { return is_in_doorway(each, place_); });
  return door != doors_.end() ? &*door : nullptr;
}

double BlockageHold::distance_of_what_blocks(const RouteMap& map) const {
  const Polyline path = rest_of(path_, nearest_ahead(path_, 0, place_), place_);
  const std::optional<Eigen::Vector2d> blocker =
      what_blocks(map.space(), map.grid(), path, map.params().space.hard_radius);
  return blocker ? (*blocker - place_).norm() : std::numeric_limits<double>::infinity();
}

void BlockageHold::leave_for(const Eigen::Vector2d& place, std::int64_t now) {
  place_ = place;
  sent_ = now;
  since_ = 0;
}

std::optional<PathOrder> BlockageHold::wait_beside(RouteMap& map, const Door& door, const Polyline& path,
                                                   std::int64_t now) {
  const double max_length = kDetour + polyline_length(path);
  std::vector<Eigen::Vector2d> places = places_beside(door, path, map.space());
  places.resize(std::min(places.size(), kPlacesTried));
  for (const Eigen::Vector2d& place : places) {
    const Route there = map.plan({path.front(), place, 0.0});
    if (there.outcome == RouteOutcome::kFound && polyline_length(there.points) < max_length) {
      leave_for(place, now);
      ++waits_beside_;
      PathOrder order = path_to_wait(there.points, heading_of(door.world_from_door.position() - place));
      order.heading_tolerance = kBesideFacing;
      return order;
    }
  }
  return std::nullopt;
}

std::optional<PathOrder> BlockageHold::make_way(RouteMap& map, const Pose2& world_from_robot, std::int64_t now) {
  const Door* door = blocking_door(map);
  if (door == nullptr || distance_of_what_blocks(map) > std::min(kWantsToPass, blocker_distance_ - kComeNearer)) {
    return std::nullopt;
  }
  Polyline path = path_;
  path.front() = world_from_robot.position();
  return wait_beside(map, *door, path, now);
}

std::optional<PathOrder> BlockageHold::face_blockage(const RouteMap& map, const Pose2& world_from_robot,
                                                     std::int64_t now) {
  const bool is_due = last_facing_ == 0 || seconds_of(now - last_facing_) >= kFacingPeriod;
  if (since_ == 0 || seconds_waited(now) < kFacingAfter || is_look_ || !is_due) {
    return std::nullopt;
  }
  const Eigen::Vector2d robot = world_from_robot.position();
  const Polyline path = rest_of(path_, nearest_ahead(path_, 0, robot), robot);
  const std::optional<Eigen::Vector2d> blocker =
      what_blocks(map.space(), map.grid(), path, map.params().space.hard_radius);
  if (!blocker) {
    return std::nullopt;
  }
  const double theta = heading_of(*blocker - robot);
  if (std::abs(wrap_angle(theta - world_from_robot.theta)) < kFacingAngle) {
    return std::nullopt;
  }
  last_facing_ = now;
  return path_to_wait({robot}, theta);
}

std::optional<PathOrder> BlockageHold::look_again(RouteMap& map, const RouteRequest& request, const Route& route,
                                                  std::int64_t now) {
  if (since_ == 0 || seconds_waited(now) < kLookAgain || has_looked_again_) {
    return std::nullopt;
  }
  has_looked_again_ = true;
  if (route.outcome != RouteOutcome::kGoalBlocked || !route.nearest_reachable) {
    return std::nullopt;
  }
  const Route there = map.plan({request.start, *route.nearest_reachable, kHoldTolerance});
  if (there.outcome != RouteOutcome::kFound || there.points.size() < 2) {
    return std::nullopt;
  }
  leave_for(place_, now);
  return path_to_wait(there.points, heading_of(request.goal - *route.nearest_reachable));
}

std::vector<SuspectedObstacle> BlockageHold::evidence(const RouteMap& map) const {
  const GridGeometry& geometry = map.space().geometry();
  const Cell centre = geometry.cell_at(blockage_.place);
  const int reach = static_cast<int>(kEvidenceRadius / geometry.resolution);
  std::vector<SuspectedObstacle> obstacles;
  for (int row = centre.row - reach; row <= centre.row + reach; ++row) {
    for (int column = centre.column - reach; column <= centre.column + reach; ++column) {
      const Cell cell{column, row};
      const Eigen::Vector2d place = geometry.centre_of(cell);
      if (geometry.contains(cell) && (place - blockage_.place).norm() <= kEvidenceRadius &&
          map.space().is_solid(cell) && map.grid().prior[geometry.index(cell)] == Prior::kFree) {
        obstacles.push_back({place, 0.5 * geometry.resolution});
      }
    }
  }
  return obstacles;
}

}  // namespace luminav
