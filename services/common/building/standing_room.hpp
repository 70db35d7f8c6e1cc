#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// Where the robot's centre may be on a map, in connected parts.
class StandingRoom {
 public:
  static constexpr double kRobotRadius = 0.25;  // [m] must fit

  explicit StandingRoom(const PriorMap& map);

  [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }
  /// Number of the part a cell belongs to, by its index; 0 where the robot does not fit.
  [[nodiscard]] int part(std::size_t cell) const { return part_[cell]; }
  /// The same at a point [m, world].
  [[nodiscard]] int part_at(const Eigen::Vector2d& point) const;
  /// The part with the most cells; 0 = there is none.
  [[nodiscard]] int largest() const { return largest_; }
  [[nodiscard]] int parts() const { return parts_; }

 private:
  std::size_t flood(const std::vector<bool>& is_allowed, std::size_t start, int part);

  GridGeometry geometry_;
  std::vector<int> part_;
  int parts_ = 0;
  int largest_ = 0;
};

/// The map as the planner takes it: a keep-out zone is as good as a wall.
PriorMap with_keep_out(PriorMap map, const std::vector<Zone>& zones);

}  // namespace luminav
