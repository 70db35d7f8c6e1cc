#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "services/detector/reduced_image.hpp"

namespace luminav {

/// Cells of one row, both ends included.
struct Run {
  int row = 0;
  int first = 0;
  int last = 0;
};

/// A connected part (8 neighbours) of a mask.
struct Region {
  int cells = 0;
  int left = 0;
  int right = 0;
  int top = 0;
  int bottom = 0;
  std::span<const Run> runs;  // from the top, each row's from the left
};

/// Which rows of a mask can hold anything: those whose brightest cell lies above the level that it was cut out at. All
/// of them when there are no peaks.
struct FilledRows {
  std::span<const std::uint8_t> peaks;
  int level = 0;

  [[nodiscard]] bool may_be(int row) const { return peaks.empty() || peaks[static_cast<std::size_t>(row)] > level; }
};

/// Finds the connected parts of a mask from its runs: the cost follows the number of runs, not of cells.
class RegionFinder {
 public:
  /// Parts of at least `least_cells` cells; valid until the next call.
  const std::vector<Region>& find(const Raster& mask, int least_cells, const FilledRows& filled = {});

 private:
  int root(int run);

  std::vector<Run> runs_;
  std::vector<int> parent_;
  std::vector<int> region_of_root_;
  std::vector<int> cells_;             // per root
  std::vector<int> run_counts_;        // per root
  std::vector<Run> runs_by_region_;    // region after region
  std::vector<std::size_t> runs_end_;  // per region: of those filled in
  std::vector<Region> regions_;
};

}  // namespace luminav
