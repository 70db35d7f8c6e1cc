#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// Steps to the eight neighbours, as columns and rows.
inline constexpr std::array<Cell, 8> kLaneSteps = {
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};

/// Which steps from cell to cell the one-way zones leave. Empty where there is none: then nothing is kept, and nothing
/// asked.
class LaneMap {
 public:
  LaneMap() = default;
  /// Takes the one-way zones of all.
  LaneMap(const std::vector<Zone>& zones, const GridGeometry& geometry);

  [[nodiscard]] bool empty() const { return lanes_.empty(); }
  /// Per cell, row-major: bit i set, the i-th of `kLaneSteps` may neither begin nor end there. nullptr when empty.
  [[nodiscard]] const std::uint8_t* forbidden() const { return lanes_.empty() ? nullptr : forbidden_.data(); }
  /// True if the i-th of `kLaneSteps` may lead from one cell to the next.
  [[nodiscard]] bool allows(std::size_t from, std::size_t to, std::size_t i) const {
    return lanes_.empty() || ((forbidden_[from] | forbidden_[to]) >> i & 1) == 0;
  }
  /// True if a straight piece [m, world] goes against a zone that it touches, sampled at half a cell.
  [[nodiscard]] bool is_against(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

 private:
  GridGeometry geometry_;
  std::vector<Zone> lanes_;
  std::vector<std::uint8_t> forbidden_;
};

}  // namespace luminav
