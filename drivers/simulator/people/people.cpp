#include "drivers/simulator/people/people.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {

using Eigen::Vector2d;

void People::step(double dt, const RobotAmongPeople& robot) {
  walk_pedestrians(dt, robot);
  walk_visitors(dt, robot);
}

void People::walk_pedestrians(double dt, const RobotAmongPeople& robot) {
  for (std::size_t i = 0; i < pedestrians_.size(); ++i) {
    const Vector2d& here = pedestrians_[i].position();
    pedestrians_[i].step(dt, [&](const Vector2d& next, bool is_beside_line) {
      if (!robot.carried) {
        const double gap = distance(robot.footprint, next) - kPersonRadius;
        if (gap < kPersonGap && gap < distance(robot.footprint, here) - kPersonRadius) {
          return Obstruction::kRobot;
        }
      }
      for (std::size_t door = 0; door < scene_.doors(); ++door) {
        if (scene_.is_door_closed(door) && distance(scene_.door_leaf(door), next) < kPersonRadius) {
          return Obstruction::kDoor;
        }
      }
      if (is_beside_line && !stands_clear(next, 0.0)) {
        return Obstruction::kWall;
      }
      return Obstruction::kNone;
    });
    scene_.set_person(i, pedestrians_[i].position());
  }
}

void People::walk_visitors(double dt, const RobotAmongPeople& robot) {
  for (Visitor& visitor : visitors_) {
    const double gap = distance(robot.footprint, visitor.position());
    visitor.step(dt, robot.world_from_robot, [&](const Vector2d& next) {
      // away from the robot he may always go
      return is_free(next, robot) || (gap < kPersonRadius + kPersonGap && distance(robot.footprint, next) > gap);
    });
  }
  std::erase_if(visitors_, [](const Visitor& visitor) { return visitor.is_gone(); });
  place_visitors();
}

bool People::is_free(const Vector2d& point, const RobotAmongPeople& robot, double room) const {
  if (!robot.carried && distance(robot.footprint, point) - kPersonRadius < kPersonGap) {
    return false;
  }
  return stands_clear(point, room);
}

bool People::stands_clear(const Vector2d& point, double room) const {
  const double side = 2.0 * (kPersonRadius + room);
  const Separation separation = scene_.separation(rectangle({point.x(), point.y(), 0.0}, side, side));
  return separation.to(SolidKind::kWall) > 0.0 && separation.to(SolidKind::kBox) > 0.0;
}

bool People::add_visitor(const VisitorHabit& habit, const RobotAmongPeople& robot) {
  constexpr double kBehind = 1.3;  // [m] from the robot's middle
  constexpr double kRoom = 0.25;   // [m] to all sides: nobody waits in a doorway
  constexpr int kDirections = 16;
  const Pose2& pose = robot.world_from_robot;
  for (int i = 0; i < kDirections; ++i) {
    const int turn = (i % 2 == 0 ? 1 : -1) * ((i + 1) / 2);  // straight behind it first
    const double theta = pose.theta + kPi + 2.0 * kPi * turn / kDirections;
    const Vector2d direction(std::cos(theta), std::sin(theta));
    bool is_open = true;
    for (double reach = 0.7; reach <= kBehind && is_open; reach += 0.2) {
      is_open = is_free(pose.position() + reach * direction, robot);
    }
    if (is_open && is_free(pose.position() + kBehind * direction, robot, kRoom)) {
      visitors_.emplace_back(habit, pose.position() + kBehind * direction);
      place_visitors();
      return true;
    }
  }
  return false;
}

bool People::add_bystander(const Vector2d& position, const RobotAmongPeople& robot) {
  if (!is_free(position, robot)) {
    return false;
  }
  visitors_.emplace_back(VisitorHabit{.speed = 0.0}, position);
  place_visitors();
  return true;
}

void People::remove_visitors() {
  std::erase_if(visitors_, [](const Visitor& visitor) { return visitor.follows(); });
  place_visitors();
}

void People::remove_bystanders() {
  std::erase_if(visitors_, [](const Visitor& visitor) { return !visitor.follows(); });
  place_visitors();
}

const Visitor* People::visitor() const {
  const auto found =
      std::find_if(visitors_.begin(), visitors_.end(), [](const Visitor& visitor) { return visitor.follows(); });
  return found == visitors_.end() ? nullptr : &*found;
}

void People::place_visitors() {
  scene_.set_people(pedestrians_.size() + visitors_.size());
  for (std::size_t i = 0; i < visitors_.size(); ++i) {
    scene_.set_person(pedestrians_.size() + i, visitors_[i].position());
  }
}

}  // namespace luminav
