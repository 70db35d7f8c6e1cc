#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "drivers/simulator/geometry/distance_field.hpp"
#include "drivers/simulator/geometry/random_stream.hpp"
#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// Passage that counts as open [m], half of its width: a region ends where the way narrows to less than twice this.
inline constexpr double kPassage = 0.35;

/// The part of a map where a robot can stand and go: its largest connected free region.
class FreeSpace {
 public:
  /// Throws ConfigurationError when the map has no free space that is wide enough.
  explicit FreeSpace(const PriorMap& map);

  /// Uniform over the cells of the largest region with at least `clearance` [m] to everything that is not free. Throws
  /// ConfigurationError when no cell has it.
  [[nodiscard]] Eigen::Vector2d draw_point(double clearance, SplitMix& generator) const;
  /// True when the point lies in the largest region with that clearance [m].
  [[nodiscard]] bool contains(const Eigen::Vector2d& point, double clearance) const;
  /// True when a disc of this radius [m] can be moved straight from one point to the other through free space.
  [[nodiscard]] bool is_free_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius) const;
  /// [m] to everything that is not free.
  [[nodiscard]] const DistanceField& distances() const { return distances_; }

 private:
  DistanceField distances_;
  std::vector<std::uint32_t> region_;  // indices of the largest region's cells
  std::vector<bool> in_region_;
};

/// Connected regions (four neighbours) of the cells that pass; -1 where they do not. Numbers follow the cells' order.
std::vector<int> label_regions(const GridGeometry& geometry, const std::vector<bool>& passes);

}  // namespace luminav
