#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace luminav::simulated {

/// Finds points near a point in a time that does not grow with the building: a hash of square cells.
class PointIndex {
 public:
  PointIndex() = default;
  explicit PointIndex(const std::vector<Eigen::Vector2d>& points);

  /// Numbers of all points within `radius` [m], and of some a little farther, in ascending order.
  void near(const Eigen::Vector2d& centre, double radius, std::vector<int>& found) const;

 private:
  static constexpr double kCell = 4.0;  // [m]
  [[nodiscard]] static std::int64_t cell_of(double coordinate);
  [[nodiscard]] static std::int64_t key_of(std::int64_t column, std::int64_t row);
  std::unordered_map<std::int64_t, std::vector<int>> cells_;
};

}  // namespace luminav::simulated
