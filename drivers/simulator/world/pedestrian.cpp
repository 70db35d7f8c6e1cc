#include "drivers/simulator/world/pedestrian.hpp"

namespace luminav {
namespace {

constexpr double kPatience = 5.0;  // [s] of waiting for the robot before walking back

}  // namespace

Pedestrian::Pedestrian(const WalkingPerson& plan) : plan_(plan), position_(plan.waypoints.front()) {}

void Pedestrian::step(double dt, const std::function<Obstruction(const Eigen::Vector2d&)>& obstruction) {
  const Eigen::Vector2d offset = plan_.waypoints[next_] - position_;
  const double step = plan_.speed * dt;
  const bool arrives = offset.norm() <= step;
  const Eigen::Vector2d next =
      arrives ? plan_.waypoints[next_] : Eigen::Vector2d(position_ + offset.normalized() * step);
  switch (obstruction(next)) {
    case Obstruction::kNone:
      waiting_ = 0.0;
      position_ = next;
      if (arrives) {
        choose_next_waypoint();
      }
      break;
    case Obstruction::kRobot:
      waiting_ += dt;
      if (waiting_ > kPatience) {
        turn_round();
      }
      break;
    case Obstruction::kDoor:
      turn_round();
      break;
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
  next_ = forward_ ? next_ - 1 : next_ + 1;
  forward_ = !forward_;
}

}  // namespace luminav
