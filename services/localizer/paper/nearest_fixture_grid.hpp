#pragma once

#include <cstdint>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/common/ceiling/fixture_map.hpp"

namespace luminav {

/// The fixture nearest to each cell of a grid: one look-up for each point. A point in a cell may be nearer to another
/// one by as much as the cell is wide, about half way between two fixtures, where no particle fits either.
class NearestFixtureGrid {
 public:
  static constexpr double kFarthest = 3.0;  ///< [m] from a cell beyond which a fixture is none of its

  explicit NearestFixtureGrid(const FixtureMap& map);

  struct Entry {
    float x, y, theta;  // [m, m, rad] world_from_fixture
    float period;       // [rad] turn after which it looks the same; 0: any
  };
  /// Where no fixture is near, the answer is a round one far away.
  [[nodiscard]] const Entry& at(float x, float y) const {
    const float column =
        (x - origin_x_) * cells_per_metre_;  // of the cells, as float: GridGeometry's takes twice as long
    const float row = (y - origin_y_) * cells_per_metre_;
    const bool is_inside = column >= 0.0F && row >= 0.0F && column < columns_ && row < rows_;
    return entries_[is_inside ? nearest_[geometry_.index({static_cast<int>(column), static_cast<int>(row)})] : 0];
  }

 private:
  GridGeometry geometry_;
  float origin_x_ = 0.0F;  // [m] of the geometry
  float origin_y_ = 0.0F;
  float cells_per_metre_ = 0.0F;
  float columns_ = 0.0F;
  float rows_ = 0.0F;
  std::vector<std::uint32_t> nearest_;  // entry by cell
  std::vector<Entry> entries_;
};

}  // namespace luminav
