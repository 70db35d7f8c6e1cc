#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "services/planner/goals/goal_types.hpp"
#include "services/planner/goals/stop_list.hpp"

namespace luminav {

/// A path that the controller is to follow, before it has a number.
struct PathOrder {
  Polyline points;                 // [m] world; empty = stand still
  double tolerance = 0.0;          // [m] at its end; 0 = the goal's
  std::optional<double> theta;     // [rad] heading at its end, world; nothing = any
  double heading_tolerance = 0.0;  // [rad] 0 = the goal's
};

/// A path to a stop, with its heading if it has one.
PathOrder path_to_stop(const Polyline& points, const GoalStop& stop);
/// A path to where the robot stands still for a while, facing `theta` [rad, world].
PathOrder path_to_wait(const Polyline& points, double theta);

/// The path that the controller was given last, and how far the robot has come on it.
class IssuedPath {
 public:
  void issue(const PathOrder& order, const StopList& stops, std::int64_t now);
  /// Issues a path without points, unless it stands still already.
  void stand_still(const StopList& stops, std::int64_t now);
  /// Issues the same path for a goal of another id.
  void rename(std::int64_t goal_id);
  /// Looks for the point nearest to the robot [m, world], forwards only.
  void advance(const Eigen::Vector2d& robot);

  [[nodiscard]] const GoalPath& path() const { return path_; }
  [[nodiscard]] const Polyline& points() const { return path_.points; }
  /// From the robot along what is left of the path.
  [[nodiscard]] Polyline remaining(const Eigen::Vector2d& robot) const;
  [[nodiscard]] double distance_to(const Eigen::Vector2d& robot) const;
  /// The first point that lies at least `distance` [m] from the robot, beyond the one nearest to it.
  [[nodiscard]] std::optional<Eigen::Vector2d> point_ahead(const Eigen::Vector2d& robot, double distance) const;
  /// The controller says that it has come to the end of this path.
  [[nodiscard]] bool is_finished(const Situation& situation) const;

 private:
  [[nodiscard]] bool stands_still(const StopList& stops) const;

  GoalPath path_;
  std::size_t at_ = 0;  // index of the point nearest to the robot
};

}  // namespace luminav
