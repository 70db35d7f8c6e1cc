#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace luminav {

struct LookAheadParams {
  double distance = 1.0;       // [m] along the path
  double min = 0.35;           // [m] never shortened below
  double search_window = 1.5;  // [m] of path in which the robot's place is sought, forward only
};

/// The temporary goal on a path, and where the robot is along it.
struct LookAhead {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();  // [m] world
  double travelled = 0.0;                           // [m] of the path lie behind
  double distance_left = 0.0;                       // [m] along the path, from the robot to its end
};

/// True where a robot can drive straight from one world point to another.
using LineTest = std::function<bool(const Eigen::Vector2d&, const Eigen::Vector2d&)>;

/// Finds the temporary goal: the nearest path point at or after `travelled` plus the look-ahead distance, shortened
/// until it is in line of sight. Searching forward only keeps a path that crosses itself in order. The path must not be
/// empty.
LookAhead find_look_ahead(const std::vector<Eigen::Vector2d>& path, double travelled, const Eigen::Vector2d& position,
                          const LookAheadParams& params, const LineTest& is_line_free);

}  // namespace luminav
