#pragma once

#include <Eigen/Core>
#include <vector>

#include "drivers/simulator/people/pedestrian.hpp"
#include "drivers/simulator/people/visitor.hpp"
#include "drivers/simulator/world/scene.hpp"

namespace luminav {

inline constexpr double kPersonGap = 0.1;  // [m] to the robot at which people stop

/// The robot as people meet it.
struct RobotAmongPeople {
  const Polygon& footprint;  // world
  const Pose2& world_from_robot;
  bool carried = false;  // then it is in nobody's way
};

/// Everybody in the scene: those who walk along their waypoints, and after them visitors who follow the robot and
/// bystanders. They keep clear of walls and boxes, and stop before the robot.
class People {
 public:
  People(const std::vector<WalkingPerson>& plans, Scene& scene)
      : scene_(scene), pedestrians_(plans.begin(), plans.end()) {}

  void step(double dt, const RobotAmongPeople& robot);
  /// Somebody comes up behind the robot and follows it; false when there is no room for him.
  bool add_visitor(const VisitorHabit& habit, const RobotAmongPeople& robot);
  /// Somebody stands there from now on; false when the robot does.
  bool add_bystander(const Eigen::Vector2d& position, const RobotAmongPeople& robot);
  /// Those who follow go away, or those who stand.
  void remove_visitors();
  void remove_bystanders();
  /// Who follows the robot, or is about to; null = nobody.
  [[nodiscard]] const Visitor* visitor() const;

 private:
  void walk_pedestrians(double dt, const RobotAmongPeople& robot);
  void walk_visitors(double dt, const RobotAmongPeople& robot);
  /// Somebody could stand there, with so much room [m] to all sides.
  [[nodiscard]] bool is_free(const Eigen::Vector2d& point, const RobotAmongPeople& robot, double room = 0.0) const;
  /// Likewise of walls and boxes alone.
  [[nodiscard]] bool stands_clear(const Eigen::Vector2d& point, double room) const;
  void place_visitors();

  Scene& scene_;
  std::vector<Pedestrian> pedestrians_;
  std::vector<Visitor> visitors_;
};

}  // namespace luminav
