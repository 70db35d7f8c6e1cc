#include "services/controller/following/path_follower.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kForceSmoothing = 0.3;        // [s] time constant of the repulsion
constexpr double kStayRadius = 0.12;           // [m] once there it stays until it is farther off
constexpr double kStayHeading = radians(6.0);  // [rad]
constexpr double kApproachRadius = 0.35;       // [m] within it, it aims at the last point itself
constexpr double kSteerUntil = 0.25;           // [m] nearer to the last point it steers less and less
constexpr double kTurnFrom = radians(55.0);    // [rad] heading error that starts a turn on the spot
constexpr double kTurnUntil = radians(15.0);   // [rad] and that ends it
constexpr double kSlowestTurn = 0.07;          // [rad/s] below this wheels stick

/// Direction [rad, robot frame] of a force [robot frame] without what of it pushes against a one-way zone: beside a
/// door post it slides along.
double direction_of(Eigen::Vector2d force, const FollowSituation& situation) {
  if (situation.lane) {
    const double lane = *situation.lane - situation.world_from_robot.theta;
    const Eigen::Vector2d along(std::cos(lane), std::sin(lane));
    force -= std::min(0.0, force.dot(along)) * along;
  }
  return std::atan2(force.y(), force.x());
}

}  // namespace

void PathFollower::set_path(const FollowedPath& path) {
  const bool same_end = !path.points.empty() && !path_.points.empty() && path.goal_id == path_.goal_id &&
                        path.pose_index == path_.pose_index &&
                        (path.points.back() - path_.points.back()).norm() < 0.05 && path.has_theta == path_.has_theta &&
                        std::abs(wrap_angle(path.theta - path_.theta)) < radians(2.0);
  path_ = path;
  travelled_ = 0.0;
  if (!same_end) {
    is_placed_ = is_aligned_ = is_turning_ = is_backing_ = false;
    long_turn_ = 0;
    nearest_ = 1e9;
    heading_.reset();
  }
}

void PathFollower::clear() {
  set_path(FollowedPath{});
}

bool PathFollower::is_within_tolerance(const Pose2& world_from_robot) const {
  return !path_.points.empty() && (path_.points.back() - world_from_robot.position()).norm() <= path_.tolerance;
}

double PathFollower::turn_on_the_spot(double error, const FollowSituation& situation) {
  const double rate = params_.speed.angular;
  const auto is_turn_free = [&](double angle) {
    return stop_logic_.is_free({0.0, std::copysign(rate, angle)}, std::abs(angle) / rate, situation.obstacles);
  };
  const double other_turn = error - std::copysign(2.0 * kPi, error);
  if (long_turn_ == 0 && std::abs(error) > kTurnUntil && !is_turn_free(error) && is_turn_free(other_turn)) {
    long_turn_ = other_turn > 0.0 ? 1 : -1;
  }
  // the long turn has become the short one when it has the same sign
  if (long_turn_ != 0 && (error > 0.0 ? 1 : -1) == long_turn_) {
    long_turn_ = 0;
  }
  const double turn = long_turn_ == 0 ? error : other_turn;
  const double wanted = std::clamp(params_.speed.turn_gain * turn, -rate, rate);
  return std::copysign(std::max(std::abs(wanted), kSlowestTurn), turn);
}

FollowStep PathFollower::step(const FollowSituation& situation) {
  FollowStep step;
  if (path_.points.empty()) {
    return step;
  }
  const Pose2& robot = situation.world_from_robot;
  step.look_ahead =
      find_look_ahead(path_.points, travelled_, robot.position(), params_.look_ahead, situation.is_line_free);
  travelled_ = step.look_ahead->travelled;
  const double distance = (path_.points.back() - robot.position()).norm();
  if (is_placed_ && distance > std::max(kStayRadius, params_.arrival_radius)) {
    is_placed_ = is_aligned_ = false;
    nearest_ = 1e9;
  }
  const double arrival =
      path_.tolerance > 0.0 ? std::min(params_.arrival_radius, path_.tolerance) : params_.arrival_radius;
  const bool is_near_end = distance < kApproachRadius && step.look_ahead->distance_left < 2.0 * kApproachRadius;
  if (is_near_end) {
    nearest_ = std::min(nearest_, distance);
    // it passed the point as near as it could: turning round for a centimetre or two is what people call oscillation
    const bool is_passed = nearest_ < 2.0 * arrival && distance > nearest_ + 0.01;
    is_placed_ = is_placed_ || distance < arrival || is_passed;
  }
  if (is_placed_) {
    take_final_heading(situation, step);
  } else if (is_near_end) {
    approach(situation, step);
  } else {
    drive(situation, step);
  }
  return step;
}

void PathFollower::take_final_heading(const FollowSituation& situation, FollowStep& step) {
  step.phase = FollowPhase::kAtGoal;
  if (!path_.has_theta) {
    return;
  }
  const double error = wrap_angle(path_.theta - situation.world_from_robot.theta);
  step.heading_error = error;
  const double wanted = path_.heading_tolerance > 0.0 ? std::min(params_.arrival_heading, path_.heading_tolerance)
                                                      : params_.arrival_heading;
  if (is_aligned_ && std::abs(error) > std::max(kStayHeading, wanted)) {
    is_aligned_ = false;
  }
  if (!is_aligned_ && std::abs(error) <= wanted) {
    is_aligned_ = true;
  }
  if (!is_aligned_) {
    step.phase = FollowPhase::kTurning;
    step.wanted.angular = turn_on_the_spot(error, situation);
  }
}

// The last centimetres: no forces, no look-ahead, the point itself, backwards if it lies behind.
void PathFollower::approach(const FollowSituation& situation, FollowStep& step) {
  step.phase = FollowPhase::kDriving;
  const Pose2& robot = situation.world_from_robot;
  const Eigen::Vector2d to_end = path_.points.back() - robot.position();
  const double distance = to_end.norm();
  const double error = wrap_angle(std::atan2(to_end.y(), to_end.x()) - robot.theta);
  step.force.attractive = {std::cos(error), std::sin(error)};
  if (std::abs(error) > radians(125.0) && situation.may_back) {
    is_backing_ = true;
  } else if (std::abs(error) < radians(80.0) || !situation.may_back) {
    is_backing_ = false;
  }
  const double course_error = is_backing_ ? wrap_angle(error + kPi) : error;
  step.heading_error = course_error;
  if (std::abs(course_error) > kTurnFrom) {
    is_turning_ = true;
  } else if (std::abs(course_error) < kTurnUntil) {
    is_turning_ = false;
  }
  if (is_turning_) {
    step.phase = FollowPhase::kTurning;
    step.wanted.angular = turn_on_the_spot(course_error, situation);
    return;
  }
  // clearance does not count here: the planner found room for the goal
  step.wanted = speed_law(course_error, 1.0, distance, params_.speed);
  // so near the direction to the point is mostly the pose's noise
  step.wanted.angular *= std::min(1.0, distance / kSteerUntil);
  if (is_backing_) {
    step.wanted.linear = -std::min(step.wanted.linear, 0.15);
  }
}

void PathFollower::drive(const FollowSituation& situation, FollowStep& step) {
  step.phase = FollowPhase::kDriving;
  is_backing_ = false;
  const Pose2& robot = situation.world_from_robot;
  const Eigen::Vector2d goal = PointTransform::inverse_of(robot) * step.look_ahead->point;
  step.force = virtual_force(goal, situation.obstacles, params_.forces);
  const double blend = std::min(1.0, situation.duration / kForceSmoothing);
  repulsive_ += blend * (step.force.repulsive - repulsive_);
  step.force.repulsive = repulsive_;
  const double wish = direction_of(step.force.resultant(), situation);
  const double needed = std::min(1.0, goal.norm());
  const double heading = heading_.choose(wish, needed, robot.theta, situation.duration, situation.obstacles.points());
  step.heading_error = heading;
  if (std::abs(heading) > kTurnFrom) {
    is_turning_ = true;
  } else if (std::abs(heading) < kTurnUntil) {
    is_turning_ = false;
    long_turn_ = 0;
  }
  if (is_turning_) {
    step.phase = FollowPhase::kTurning;
    step.wanted.angular = turn_on_the_spot(heading, situation);
    return;
  }
  // of what lies ahead; what is behind does not slow it down
  const double clearance = situation.obstacles.min_distance_ahead(params_.speed.wide);
  step.wanted = speed_law(heading, clearance, step.look_ahead->distance_left, params_.speed);
}

}  // namespace luminav
