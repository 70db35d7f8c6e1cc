#include "drivers/simulator/people/pedestrian.hpp"

#include <algorithm>

namespace luminav {
namespace {

using Eigen::Vector2d;

constexpr double kGiveWayAfter = 1.0;  // [s] of waiting for the robot
constexpr double kPatience = 10.0;     // [s] of waiting for the robot before walking back
constexpr double kAside = 0.8;         // [m] from the line at most
constexpr double kRoomStep = 0.1;      // [m] between the places that are looked at for room
constexpr double kLookAhead = 1.0;     // [m] along the line, where the robot is let pass
constexpr double kMergeAhead = 0.3;    // [m] along the line, to which he comes back
constexpr double kOnLine = 1e-6;       // [m]

Vector2d left_of(const Vector2d& direction) {
  return {-direction.y(), direction.x()};
}

}  // namespace

Pedestrian::Pedestrian(const WalkingPerson& plan) : plan_(plan), position_(plan.waypoints.front()) {}

void Pedestrian::step(double dt, const FindObstruction& find_obstruction) {
  const double distance = plan_.speed * dt;
  const Vector2d& waypoint = plan_.waypoints[next_];
  const Vector2d foot = foot_on_line();
  const bool is_beside = (position_ - foot).norm() > kOnLine;
  const Vector2d left = waypoint - foot;
  const bool is_taken = is_beside && robot_is_on_line(foot, find_obstruction);
  const bool stays_aside = is_taken && !has_turned_back_;
  Vector2d target = waypoint;
  if (is_taken) {  // beside his line he walks away from a robot that stands on it
    target = position_ + left;
  } else if (is_beside) {
    target = foot + std::min(kMergeAhead, left.norm()) * left.stableNormalized();
  } else {
    has_turned_back_ = false;
  }
  const Vector2d next = towards(target, distance);
  switch (stays_aside ? Obstruction::kRobot : find_obstruction(next, is_beside)) {
    case Obstruction::kNone:
      waiting_ = 0.0;
      side_ = 0.0;
      position_ = next;
      if (position_ == waypoint) {
        choose_next_waypoint();
      }
      break;
    case Obstruction::kRobot:
      wait(dt);
      if (waiting_ > kGiveWayAfter) {
        give_way(distance, find_obstruction);
      }
      break;
    case Obstruction::kDoor:
      turn_round();
      break;
    case Obstruction::kWall:
      wait(dt);
      step_to(towards(foot, distance), false, find_obstruction);
      break;
  }
}

Vector2d Pedestrian::foot_on_line() const {
  const Vector2d& from = plan_.waypoints[forward_ ? next_ - 1 : next_ + 1];
  const Vector2d line = plan_.waypoints[next_] - from;
  const double share = line.squaredNorm() > 0.0 ? (position_ - from).dot(line) / line.squaredNorm() : 0.0;
  return from + std::clamp(share, 0.0, 1.0) * line;
}

bool Pedestrian::robot_is_on_line(const Vector2d& foot, const FindObstruction& find_obstruction) const {
  const Vector2d direction = (plan_.waypoints[next_] - foot).stableNormalized();
  for (double ahead = 0.0; ahead < kLookAhead; ahead += kRoomStep) {
    if (find_obstruction(foot + ahead * direction, false) == Obstruction::kRobot) {
      return true;
    }
  }
  return false;
}

Vector2d Pedestrian::towards(const Vector2d& target, double distance) const {
  const Vector2d offset = target - position_;
  return offset.norm() <= distance ? target : Vector2d(position_ + offset.normalized() * distance);
}

void Pedestrian::step_to(const Vector2d& next, bool is_beside_line, const FindObstruction& find_obstruction) {
  if (find_obstruction(next, is_beside_line) == Obstruction::kNone) {
    position_ = next;
  }
}

void Pedestrian::wait(double dt) {
  waiting_ += dt;
  if (waiting_ > kPatience) {
    turn_round();
    has_turned_back_ = true;
  }
}

// To the side where he finds more room, the right one where both are alike.
void Pedestrian::give_way(double distance, const FindObstruction& find_obstruction) {
  const Vector2d foot = foot_on_line();
  const Vector2d left = left_of((plan_.waypoints[next_] - foot).stableNormalized());
  if (side_ == 0.0) {
    const auto room = [&](double side) {
      double free = 0.0;
      while (free < kAside &&
             find_obstruction(position_ + side * (free + kRoomStep) * left, true) == Obstruction::kNone) {
        free += kRoomStep;
      }
      return free;
    };
    side_ = room(1.0) > room(-1.0) ? 1.0 : -1.0;
  }
  const Vector2d next = position_ + side_ * distance * left;
  if ((next - foot).norm() <= kAside) {
    step_to(next, true, find_obstruction);
  }
}

void Pedestrian::choose_next_waypoint() {
  if (forward_ ? next_ + 1 == plan_.waypoints.size() : next_ == 0) {
    turn_round();
  } else {
    next_ = forward_ ? next_ + 1 : next_ - 1;
  }
}

void Pedestrian::turn_round() {
  waiting_ = 0.0;
  side_ = 0.0;
  next_ = forward_ ? next_ - 1 : next_ + 1;
  forward_ = !forward_;
}

}  // namespace luminav
