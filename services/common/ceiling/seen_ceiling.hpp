#pragma once

#include <Eigen/Core>
#include <vector>

namespace luminav {

/// The part of a ceiling that a survey saw: around the places that it passed. All lamps there are in the building's
/// file.
class SeenCeiling {
 public:
  /// Places of the robot [m, world] from which it saw the ceiling.
  explicit SeenCeiling(const std::vector<Eigen::Vector2d>& places);

  /// True for a point of the ceiling [m, world] within 1 m of such a place.
  [[nodiscard]] bool contains(const Eigen::Vector2d& point) const;

 private:
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();  // [m] world, lower left corner of the cells
  int columns_ = 0;
  int rows_ = 0;
  std::vector<bool> cells_;  // row by row
};

}  // namespace luminav
