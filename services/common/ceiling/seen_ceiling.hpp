#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_set>
#include <vector>

namespace luminav {

/// The part of a ceiling that a survey saw: around the places that it passed. All lamps there are in the building's
/// file.
class SeenCeiling {
 public:
  /// Places of the robot [m, world, within 100 km] from which it saw the ceiling.
  explicit SeenCeiling(const std::vector<Eigen::Vector2d>& places);

  /// True for a point of the ceiling [m, world] within 1 m of such a place, to 0.2 m.
  [[nodiscard]] bool contains(const Eigen::Vector2d& point) const;

 private:
  std::unordered_set<std::int64_t> cells_;
};

}  // namespace luminav
