#pragma once

#include <Eigen/Core>
#include <deque>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <vector>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// How somebody behaves whom the robot leads.
struct VisitorHabit {
  double speed = 1.2;                                            // [m/s] at most; 0: stands where he is
  double stops_after = std::numeric_limits<double>::infinity();  // [m] of following
  double stops_for = 0.0;                                        // [s], then he comes on
  bool leaves = false;                                           // instead he turns away for good
};

/// Somebody who follows the robot, a metre behind it on the robot's own way, and steps aside when it comes towards him.
class Visitor {
 public:
  Visitor(const VisitorHabit& habit, const Eigen::Vector2d& position) : habit_(habit), position_(position) {}

  /// `is_free` says whether he could stand at a point.
  void step(double dt, const Pose2& world_from_robot, const std::function<bool(const Eigen::Vector2d&)>& is_free);

  [[nodiscard]] const Eigen::Vector2d& position() const { return position_; }
  /// False for one who stands where he is.
  [[nodiscard]] bool follows() const { return habit_.speed > 0.0; }
  /// He is on his way back, for good.
  [[nodiscard]] bool has_turned_away() const { return habit_.leaves && followed_ >= habit_.stops_after; }
  /// He turned away, and is out of sight.
  [[nodiscard]] bool is_gone() const { return gone_; }

 private:
  using IsFree = std::function<bool(const Eigen::Vector2d&)>;

  bool step_aside(double dt, const Pose2& world_from_robot, const IsFree& is_free);
  /// In the first of the directions [rad] that is free; returns by how much he turned [rad], nothing = he stands.
  std::optional<double> walk(double step, double direction, std::initializer_list<double> turns, const IsFree& is_free);
  void follow(double dt, const Eigen::Vector2d& robot, const IsFree& is_free);
  void walk_back(double dt);

  VisitorHabit habit_;
  Eigen::Vector2d position_;             // [m] world
  std::deque<Eigen::Vector2d> trail_;    // [m] of the robot, from him to it
  std::vector<Eigen::Vector2d> walked_;  // [m] his own way
  double side_ = 1.0;                    // on which he walks round what is in his way: 1 left, -1 right
  double followed_ = 0.0;                // [m]
  double stood_ = 0.0;                   // [s] since he stopped
  double left_ = 0.0;                    // [m] since he turned away
  bool gone_ = false;
};

}  // namespace luminav
