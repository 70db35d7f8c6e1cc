#include "services/controller/safety/stop_logic.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "services/common/geometry/seconds.hpp"

namespace luminav {
namespace {

constexpr double kStep = 0.03;     // [m] the fastest corner moves between two checks; half the margin
constexpr double kCloser = 0.004;  // [m] less than this is standing still, not approaching
constexpr std::array kShares{1.0, 0.85, 0.7, 0.55, 0.4, 0.3, 0.2, 0.12, 0.06};

std::string describe(const ObstaclePoint& obstacle) {
  std::array<char, 120> text{};
  const double side = std::atan2(obstacle.position.y(), obstacle.position.x());
  const char* where = std::abs(side) < radians(35.0)    ? "ahead"
                      : std::abs(side) > radians(145.0) ? "behind"
                      : side > 0.0                      ? "on the left"
                                                        : "on the right";
  std::snprintf(text.data(), text.size(), "%s %s, %.2f m from the wheel axis",
                obstacle.zone_edge != ZoneEdge::kNone ? "edge of a keep-out zone"
                : obstacle.is_known                   ? "wall"
                                                      : "something",
                where, obstacle.position.norm());
  return text.data();
}

}  // namespace

void judge_disc_ages(const EchoMemory& echoes, std::int64_t now, SenseAges& ages) {
  ages.has_sonar = !echoes.ring().robot_from_sonar.empty();
  double front = -1.0;
  double rear = -1.0;
  for (std::size_t i = 0; i < echoes.newest().size(); ++i) {
    const SonarFiring& firing = echoes.newest()[i];
    const double age = firing.utime == 0 ? 1e9 : std::max(0.0, seconds_between(firing.utime, now));
    const double axis = std::abs(echoes.ring().robot_from_sonar[i].theta);
    ages.sonar = std::min(ages.sonar, age);
    if (axis < radians(45.0)) {
      front = std::max(front, age);
    } else if (axis > radians(135.0)) {
      rear = std::max(rear, age);
    }
  }
  ages.front_sonar = front < 0.0 ? 1e9 : front;
  ages.rear_sonar = rear < 0.0 ? 1e9 : rear;
}

StopLogic::StopLogic(const RobotDescription& robot, const StopLogicParams& params)
    : footprint_(robot.footprint), limits_(robot.limits), params_(params) {}

double StopLogic::look_ahead_time(const DriveTwist& twist) const {
  const double braking = params_.reaction_time + 0.5 * std::abs(twist.linear) / limits_.linear_deceleration;
  return std::max(params_.time_to_contact, braking);
}

std::optional<std::size_t> StopLogic::first_obstruction(const DriveTwist& twist, double duration,
                                                        const Obstacles& obstacles) const {
  const double corner_speed = std::abs(twist.linear) + footprint_.swept_radius() * std::abs(twist.angular);
  if (corner_speed <= 0.0) {
    return std::nullopt;
  }
  const int steps = std::max(1, static_cast<int>(std::ceil(corner_speed * duration / kStep)));
  std::vector<PointTransform> end_from_start;  // as many as were needed so far: mostly nothing is near
  // somebody who comes stops before a robot that stands, so his own distance counts until it does
  const double until_still =
      std::min(duration, params_.reaction_time + std::abs(twist.linear) / limits_.linear_deceleration);
  double longest_own_distance = 0.0;
  for (const ObstaclePoint& obstacle : obstacles.measured()) {
    longest_own_distance = std::max(longest_own_distance, obstacle.approach * (obstacle.age + until_still));
  }
  // A robot that stands nearer than the margin may go along the obstacle, not only away from it.
  std::optional<double> room;
  std::optional<std::size_t> first;
  int first_step = steps;
  // no point of the outline moves farther than its fastest corner
  const double sweep = corner_speed * duration;
  const double widest_margin = std::max(params_.margin, params_.known_margin);
  obstacles.visit_within(sweep + widest_margin + longest_own_distance, [&](std::size_t index) {
    const ObstaclePoint& obstacle = obstacles.points()[index];
    if (obstacle.zone_edge == ZoneEdge::kPossible && twist.linear == 0.0) {
      return;
    }
    const double own_distance = obstacle.approach * (obstacle.age + until_still);
    const double whole_margin = obstacle.is_known ? params_.known_margin : params_.margin;
    if (footprint_.distance_from_box(obstacle.position) > sweep + whole_margin + own_distance) {
      return;
    }
    if (!room) {
      room = clearance(obstacles);
    }
    const double margin = std::min(*room, whole_margin);
    for (int i = 0; i < first_step; ++i) {
      if (end_from_start.size() <= static_cast<std::size_t>(i)) {
        end_from_start.push_back(PointTransform::inverse_of(drive_arc(twist, duration * (i + 1) / steps)));
      }
      const Eigen::Vector2d position = end_from_start[static_cast<std::size_t>(i)] * obstacle.position;
      const double time = duration * (i + 1) / steps;
      const double nearer = obstacle.approach * (obstacle.age + std::min(time, until_still));
      if (footprint_.distance_from_box(position) > margin + nearer) {
        continue;
      }
      const double later = footprint_.distance(position);
      if (later - nearer < margin && later < footprint_.distance(obstacle.position) - kCloser) {
        first = index;
        first_step = i;
        break;
      }
    }
  });
  return first;
}

bool StopLogic::is_free(const DriveTwist& twist, double duration, const Obstacles& obstacles) const {
  return !first_obstruction(twist, duration, obstacles);
}

double StopLogic::clearance(const Obstacles& obstacles) const {
  return std::max(0.0, obstacles.min_distance(10.0));
}

StopVerdict StopLogic::judge(const DriveTwist& wanted, const Obstacles& obstacles, const SenseAges& ages) const {
  StopVerdict verdict;
  const bool is_deaf = ages.has_sonar && ages.sonar > params_.silent_after;
  if (ages.odometry > params_.silent_after || is_deaf) {
    verdict.limited = verdict.blocked = true;
    verdict.reason =
        ages.odometry > params_.silent_after ? "no odometry for half a second" : "no sonar for half a second";
    return verdict;
  }
  DriveTwist possible{std::clamp(wanted.linear, -limits_.linear, limits_.linear),
                      std::clamp(wanted.angular, -limits_.angular, limits_.angular)};
  const double fastest = !ages.has_sonar       ? params_.bumper_linear
                         : !ages.doubt.empty() ? params_.doubtful_linear
                                               : limits_.linear;
  if (std::abs(possible.linear) > fastest) {
    const double share = fastest / std::abs(possible.linear);
    possible = {share * possible.linear, share * possible.angular};  // the same arc
  }
  const bool ahead = possible.linear > 0.0;
  const double silence = ahead ? ages.front_sonar : ages.rear_sonar;
  if (possible.linear != 0.0 && ages.has_sonar && silence > params_.disc_silent_after) {
    verdict.reason = ahead ? "the front sonars are silent" : "no sonar sees what is behind";
    possible.linear = 0.0;
  }
  if (possible.linear != 0.0 && (ahead ? ages.front_bumper : ages.rear_bumper)) {
    verdict.reason = ahead ? "a front bumper is pressed" : "a rear bumper is pressed";
    possible.linear = 0.0;
  }
  verdict.limited = !verdict.reason.empty();
  const double duration = look_ahead_time(possible);
  const std::optional<std::size_t> obstruction = first_obstruction(possible, duration, obstacles);
  if (!obstruction) {
    verdict.twist = possible;
    verdict.blocked = verdict.limited;
    return verdict;
  }
  verdict.limited = true;
  verdict.by_unknown = !obstacles.points()[*obstruction].is_known;
  verdict.reason = describe(obstacles.points()[*obstruction]);
  for (const double share : kShares) {
    const DriveTwist slower{share * possible.linear, share * possible.angular};
    if (share < 1.0 && is_free(slower, duration, obstacles)) {
      verdict.twist = slower;
      return verdict;
    }
  }
  verdict.blocked = true;
  for (const double share : kShares) {
    const DriveTwist turn{0.0, share * possible.angular};
    if (possible.linear != 0.0 && possible.angular != 0.0 && is_free(turn, duration, obstacles)) {
      verdict.twist = turn;
      break;
    }
  }
  return verdict;
}

}  // namespace luminav
