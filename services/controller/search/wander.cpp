#include "services/controller/search/wander.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kPlaceSide = 0.5;            // [m] of the squares in which it counts where it has been
constexpr double kReach = 3.0;                // [m] a direction is worth at most so much free distance
constexpr double kBlockedBelow = 0.40;        // [m] less free distance ahead makes it look for another direction
constexpr double kDecideEvery = 1.2;          // [m] driven straight on before it looks for a better direction
constexpr double kBetterBy = 1.5;             // squares' worth that another direction must offer to leave a free one
constexpr double kFailureMemory = 30.0;       // [s] a direction that ended at an obstacle is avoided near that place
constexpr double kFailureRadius = 1.0;        // [m]
constexpr double kFadeEvery = 5.0;            // [m] beyond `look_around` after which old echoes count less
constexpr double kLookAhead = 0.6;            // [m] along the path to new ground
constexpr double kApproachWithin = 12.0;      // [s] it must have come nearer to where it goes, else it goes elsewhere
constexpr double kStayWithin = 0.7;           // [m] it has moved so little ...
constexpr double kMaxStay = 15.0;             // [s] for so long: the path leads nowhere
constexpr double kDeadEndFrom = 0.35;         // [m] along the path: so near to where it stayed
constexpr double kDeadEndUntil = 1.2;         // [m] to so far
constexpr double kTurnFrom = radians(50.0);   // [rad] off its path that starts a turn on the spot
constexpr double kTurnUntil = radians(20.0);  // [rad] and that ends it

}  // namespace

void Wander::clear() {
  visits_.clear();
  failures_.clear();
  last_step_ = 0;
  decided_at_.reset();
  turn_.is_to_new_heading = turn_.is_to_path = false;
  turn_.left = 0.0;
  heading_.reset();
  map_.clear();
  path_.points.clear();
  path_.planned = path_.approached = 0;
  driven_ = faded_at_ = 0.0;
  last_place_.reset();
  began_at_.reset();
  stay_.place.reset();
  repulsive_.setZero();
}

Wander::Square Wander::square_at(const Eigen::Vector2d& place) const {
  return {static_cast<int>(std::floor(place.x() / kPlaceSide)), static_cast<int>(std::floor(place.y() / kPlaceSide))};
}

// Free distance counts by how little it was visited: a square never seen 1, one where it spent 4 s a half.
double Wander::worth(double direction, std::int64_t now, const Pose2& odom_from_robot,
                     std::span<const ObstaclePoint> obstacles) const {
  const double distance = free_distance(direction, kReach, obstacles, params_.heading.free_heading);
  if (distance < kBlockedBelow) {
    return -10.0 + distance;
  }
  double sum = 0.0;
  for (double ahead = kPlaceSide; ahead <= distance + 0.1; ahead += kPlaceSide) {
    const Eigen::Vector2d place =
        odom_from_robot * Eigen::Vector2d(ahead * std::cos(direction), ahead * std::sin(direction));
    const auto visit = visits_.find(square_at(place));
    sum += visit == visits_.end() ? 1.0 : 1.0 / (1.0 + 0.25 * visit->second);
  }
  for (const Failure& failure : failures_) {
    const bool is_here = (failure.place - odom_from_robot.position()).norm() < kFailureRadius;
    const double apart = std::abs(wrap_angle(odom_from_robot.theta + direction - failure.heading));
    if (is_here && apart < radians(35.0) && seconds_between(failure.utime, now) < kFailureMemory) {
      sum -= 2.0;
    }
  }
  return sum - 0.5 * std::abs(direction);
}

void Wander::note_failure(std::int64_t now, const Pose2& odom_from_robot, double heading) {
  constexpr std::size_t kMaxFailures = 30;
  failures_.push_back({now, odom_from_robot.position(), heading});
  if (failures_.size() > kMaxFailures) {
    failures_.pop_front();
  }
}

void Wander::give_up(std::int64_t now, const Pose2& odom_from_robot) {
  note_failure(now, odom_from_robot, turn_.is_to_new_heading ? turn_.target : odom_from_robot.theta);
  if (!path_.points.empty()) {
    end_path(odom_from_robot.position());
  }
  turn_.is_to_new_heading = turn_.is_to_path = false;
  heading_.reset();
  decided_at_.reset();
}

double Wander::turn_side(double angle, const Obstacles& obstacles) const {
  const auto is_free = [&](double turn) {
    return stop_logic_.is_free({0.0, std::copysign(params_.angular, turn)}, std::abs(turn) / params_.angular,
                               obstacles);
  };
  const double sign = angle > 0.0 ? 1.0 : -1.0;
  return !is_free(angle) && is_free(angle - sign * 2.0 * kPi) ? -sign : sign;
}

void Wander::decide(bool is_blocked, std::int64_t now, const Pose2& odom_from_robot,
                    std::span<const ObstaclePoint> remembered) {
  const Obstacles obstacles(stop_logic_.footprint(), remembered);
  decided_at_ = odom_from_robot.position();
  double best = 0.0;
  double best_worth = is_blocked ? -100.0 : worth(0.0, now, odom_from_robot, obstacles.points()) + kBetterBy;
  for (int i = -17; i <= 18; ++i) {
    const double direction = radians(10.0 * i);
    const double value = worth(direction, now, odom_from_robot, obstacles.points());
    if (std::abs(direction) > radians(25.0) && value > best_worth) {
      best_worth = value;
      best = direction;
    }
  }
  if (best == 0.0) {
    return;
  }
  turn_.is_to_new_heading = true;
  turn_.target = wrap_angle(odom_from_robot.theta + best);
  turn_.sign = turn_side(best, obstacles);
}

void Wander::plan(const WanderInput& input) {
  const std::int64_t now = input.now;
  if (path_.planned != 0 && seconds_between(path_.planned, now) < params_.plan_every) {
    return;
  }
  path_.planned = now;
  const Eigen::Vector2d place = input.odom_from_robot.position();
  auto path = disambiguation_.path(
      {place, *began_at_, path_.points.empty() ? std::nullopt : std::optional(path_.points.back())}, input.alternatives,
      map_);
  if (!path && driven_ > params_.look_around) {
    path = map_.path_to_new_ground(place);
  }
  if (!path || path->empty()) {
    path_.points.clear();
    return;
  }
  const double left = 0.1 * static_cast<double>(path->size());
  const bool is_elsewhere = path_.points.empty() || (path->back() - path_.points.back()).norm() > 1.0;
  turn_.is_to_path = turn_.is_to_path && !is_elsewhere;  // the short way round may be the other one now
  if (is_elsewhere || left < path_.left - 0.2) {
    path_.approached = now;
    path_.left = left;
  }
  path_.points = std::move(*path);
  if (seconds_between(path_.approached, now) > kApproachWithin || stays(now, place)) {
    end_path(place);
  }
}

bool Wander::stays(std::int64_t now, const Eigen::Vector2d& place) {
  if (!stay_.place || (place - *stay_.place).norm() > kStayWithin) {
    stay_.place = place;
    stay_.since = now;
  }
  if (seconds_between(stay_.since, now) <= kMaxStay) {
    return false;
  }
  stay_.place.reset();
  return true;
}

// The path leads nowhere. Some pose that is possible may have a door where a wall stands, and many places behind it:
// what is narrow or unknown in front of the robot is no path for any of them.
void Wander::end_path(const Eigen::Vector2d& place) {
  for (const Eigen::Vector2d& point : path_.points) {
    const double ahead = (point - place).norm();
    if (ahead > kDeadEndFrom && ahead < kDeadEndUntil &&
        (map_.ground_at(point) != Ground::kFree || map_.stands_within(point, kSearchClearance))) {
      map_.shut(point);
    }
  }
  map_.block(path_.points.back());
  path_.points.clear();
  path_.planned = 0;
}

DriveTwist Wander::step(const WanderInput& input) {
  const double duration = last_step_ == 0 ? 0.0 : std::clamp(seconds_between(last_step_, input.now), 0.0, 0.5);
  last_step_ = input.now;
  const Eigen::Vector2d place = input.odom_from_robot.position();
  driven_ += last_place_ ? (place - *last_place_).norm() : 0.0;
  last_place_ = place;
  began_at_ = began_at_.value_or(place);
  visits_[square_at(place)] += duration;
  map_.visit(place);
  map_.add(input.firings);
  if (driven_ - std::max(faded_at_, params_.look_around) > kFadeEvery) {
    faded_at_ = driven_;
    map_.fade();
  }
  plan(input);
  turn_.left = 0.0;
  return path_.points.empty() ? explore(duration, input) : follow_path(duration, input);
}

DriveTwist Wander::follow_path(double duration, const WanderInput& input) {
  turn_.is_to_new_heading = false;
  decided_at_.reset();
  const Eigen::Vector2d place = input.odom_from_robot.position();
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < path_.points.size(); ++i) {
    nearest = (path_.points[i] - place).norm() < (path_.points[nearest] - place).norm() ? i : nearest;
  }
  std::size_t ahead = nearest;
  while (ahead + 1 < path_.points.size() && (path_.points[ahead] - place).norm() < kLookAhead) {
    ++ahead;
  }
  const Eigen::Vector2d target = input.odom_from_robot.inverse() * path_.points[ahead];
  const double direction = std::atan2(target.y(), target.x());
  if (!turn_.is_to_path && std::abs(direction) > kTurnFrom) {
    turn_.is_to_path = true;
    turn_.sign = turn_side(direction, input.obstacles);
    turn_.is_long = turn_.sign * direction < 0.0;
  }
  turn_.is_to_path = turn_.is_to_path && std::abs(direction) > kTurnUntil;
  if (turn_.is_to_path) {
    heading_.reset();
    // what lies behind changes sides with every step: once begun, the turn goes on in the same direction
    const double sign = std::abs(direction) < 0.5 * kPi && !turn_.is_long ? direction : turn_.sign;
    turn_.left = direction;
    return {0.0, std::copysign(params_.angular, sign)};
  }
  return steer(direction, duration, input);
}

DriveTwist Wander::explore(double duration, const WanderInput& input) {
  const Pose2& odom_from_robot = input.odom_from_robot;
  turn_.is_to_path = false;
  if (turn_.is_to_new_heading) {
    heading_.reset();
    const double error = wrap_angle(turn_.target - odom_from_robot.theta);
    if (std::abs(error) < radians(8.0)) {
      turn_.is_to_new_heading = false;
      decided_at_ = odom_from_robot.position();
    } else {
      turn_.left = error;
      const double rate = std::clamp(1.6 * std::abs(error), 0.15, params_.angular);
      // near the end the sign is the error's own, before that the chosen one
      return {0.0, std::abs(error) < radians(60.0) ? std::copysign(rate, error) : turn_.sign * params_.angular};
    }
  }
  const double ahead = free_distance(0.0, kReach, input.obstacles.points(), params_.heading.free_heading);
  const bool is_blocked = ahead < kBlockedBelow;
  if (is_blocked) {
    note_failure(input.now, odom_from_robot, odom_from_robot.theta);
  }
  const bool has_gone_far = !decided_at_ || (*decided_at_ - odom_from_robot.position()).norm() > kDecideEvery;
  if (is_blocked || has_gone_far) {
    decide(is_blocked, input.now, odom_from_robot, input.remembered);
    if (turn_.is_to_new_heading) {
      return {};
    }
  }
  return steer(0.0, duration, input);
}

// Towards a direction [rad, robot frame], pushed off by what is near.
DriveTwist Wander::steer(double direction, double duration, const WanderInput& input) {
  const Eigen::Vector2d attractive(std::cos(direction), std::sin(direction));
  const VirtualForce force = virtual_force(attractive, input.obstacles, {});
  repulsive_ += std::min(1.0, duration / 0.3) * (force.repulsive - repulsive_);
  const Eigen::Vector2d sum = attractive + repulsive_;
  const double wish = std::atan2(sum.y(), sum.x());
  const double heading = heading_.choose(wish, 0.9, input.odom_from_robot.theta, duration, input.obstacles.points());
  const double slowing = std::clamp((radians(50.0) - std::abs(heading)) / radians(40.0), 0.0, 1.0);
  return {params_.speed * slowing, std::clamp(1.2 * heading, -params_.angular, params_.angular)};
}

}  // namespace luminav
