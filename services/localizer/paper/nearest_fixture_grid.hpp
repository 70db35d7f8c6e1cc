#pragma once

#include <cstdint>
#include <vector>

#include "services/common/ceiling/fixture_map.hpp"
#include "services/localizer/paper/particle_kernels.hpp"

namespace luminav {

/// Which fixture is nearest to a point, exactly: each cell of a grid knows all fixtures that are the nearest one of any
/// of its points. Fixtures farther than `kFarthest` from a cell are none of its.
class NearestFixtureGrid {
 public:
  explicit NearestFixtureGrid(const FixtureMap& map);

  static constexpr double kFarthest = 3.0;           // [m]
  static constexpr std::size_t kMaxCandidates = 12;  // of one box

  /// Candidates for all points of a box; `count` is 0 when no fixture is near.
  struct BoxCandidates {
    float x[kMaxCandidates];
    float y[kMaxCandidates];
    float theta[kMaxCandidates];
    float period[kMaxCandidates];
    std::size_t count = 0;
    [[nodiscard]] NearestCandidates view() const { return {x, y, theta, period, count}; }
  };
  /// False when the box is so wide that asking for each point is quicker.
  [[nodiscard]] bool find(const PointBox& box, BoxCandidates& candidates) const;

  /// Offsets for points anywhere, one after the other; where no fixture is near the offset is kFarthest along x.
  void find_each(const float* x, const float* y, const NearestOffsets& nearest, std::size_t count) const;

 private:
  struct Entry {
    float x, y, theta, period;
    std::uint32_t fixture;
  };
  [[nodiscard]] std::int32_t column_of(float x) const;
  [[nodiscard]] std::int32_t row_of(float y) const;
  [[nodiscard]] std::size_t cell_of(std::int32_t column, std::int32_t row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

  float origin_x_ = 0.0F;  // [m] lower left corner
  float origin_y_ = 0.0F;
  float cell_ = 0.5F;  // [m]
  float cells_per_metre_ = 2.0F;
  std::int32_t columns_ = 1;
  std::int32_t rows_ = 1;
  std::vector<std::uint32_t> start_;  // CSR: entries of cell i are entries_[start_[i] .. start_[i + 1])
  std::vector<Entry> entries_;
};

}  // namespace luminav
