#pragma once

#include <Eigen/Core>
#include <map>
#include <utility>
#include <vector>

namespace luminav {

/// How often the robot set out for which floor. It keeps to the world, whatever grid that is drawn on.
class TriedFloor {
 public:
  /// A goal came to an end, good or bad, that was for the floor around some points [m, world].
  void add(const std::vector<Eigen::Vector2d>& points);
  [[nodiscard]] int tries(const Eigen::Vector2d& point) const;

 private:
  std::map<std::pair<long, long>, int> tries_;  // by cell
};

}  // namespace luminav
