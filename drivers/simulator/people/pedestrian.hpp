#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>

#include "drivers/simulator/world/scenario.hpp"

namespace luminav {

/// What a person meets who would take a step.
enum class Obstruction { kNone, kRobot, kDoor, kWall };

/// Walks along the waypoints to and fro. Where the robot is in the way he steps aside and lets it pass; he turns round
/// at a closed door, or when the waiting becomes too long: then he walks away beside a robot that stands on his line.
class Pedestrian {
 public:
  /// Says what is in the way of standing at a point [m, world]. On the line between two waypoints no wall is asked for.
  using FindObstruction = std::function<Obstruction(const Eigen::Vector2d& point, bool is_beside_line)>;

  explicit Pedestrian(const WalkingPerson& plan);

  void step(double dt, const FindObstruction& find_obstruction);
  [[nodiscard]] const Eigen::Vector2d& position() const { return position_; }

 private:
  [[nodiscard]] Eigen::Vector2d foot_on_line() const;
  [[nodiscard]] bool robot_is_on_line(const Eigen::Vector2d& foot, const FindObstruction& find_obstruction) const;
  [[nodiscard]] Eigen::Vector2d towards(const Eigen::Vector2d& target, double distance) const;
  void step_to(const Eigen::Vector2d& next, bool is_beside_line, const FindObstruction& find_obstruction);
  void wait(double dt);
  void give_way(double distance, const FindObstruction& find_obstruction);
  void choose_next_waypoint();
  void turn_round();

  WalkingPerson plan_;
  Eigen::Vector2d position_;      // [m] world
  std::size_t next_ = 1;          // waypoint walked to
  bool forward_ = true;           // through the list
  bool has_turned_back_ = false;  // for the robot, and is not on the line yet
  double waiting_ = 0.0;          // [s] for the robot
  double side_ = 0.0;             // to which he gives way: 1 left, -1 right, 0 not yet chosen
};

}  // namespace luminav
