#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>

#include "drivers/simulator/world/scenario.hpp"

namespace luminav {

/// What a person meets who would take a step.
enum class Obstruction { kNone, kRobot, kDoor };

/// Walks along the waypoints to and fro; waits where the robot is in the way and turns round at a closed door, or when
/// the waiting becomes too long.
class Pedestrian {
 public:
  explicit Pedestrian(const WalkingPerson& plan);

  /// `obstruction` says what is in the way of standing at a point.
  void step(double dt, const std::function<Obstruction(const Eigen::Vector2d&)>& obstruction);
  [[nodiscard]] const Eigen::Vector2d& position() const { return position_; }

 private:
  void choose_next_waypoint();
  void turn_round();

  WalkingPerson plan_;
  Eigen::Vector2d position_;  // [m] world
  std::size_t next_ = 1;      // waypoint walked to
  bool forward_ = true;       // through the list
  double waiting_ = 0.0;      // [s]
};

}  // namespace luminav
