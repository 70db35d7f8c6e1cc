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

/// A connected part (8 neighbours) of what is cut out.
struct Region {
  int cells = 0;
  int left = 0;
  int right = 0;
  int top = 0;
  int bottom = 0;
  std::span<const Run> runs;  // from the top, each row's from the left
};

/// The level above which cells are taken; rows whose brightest cell, where these are given, is not above it hold none.
struct Cut {
  int level = 0;
  std::span<const std::uint8_t> row_peaks;

  [[nodiscard]] bool may_be_in(int row) const {
    return row_peaks.empty() || row_peaks[static_cast<std::size_t>(row)] > level;
  }
};

/// Finds the connected parts of what is cut out of an image, or of a mask, from their runs: the cost follows the number
/// of runs, not of cells.
class RegionFinder {
 public:
  /// Parts of at least `least_cells` cells; valid until the next call.
  const std::vector<Region>& find(const Raster& image, int least_cells, const Cut& cut = {});

 private:
  void take_runs(const Raster& image, const Cut& cut);
  int root(int run);

  std::vector<std::uint64_t> bits_;  // of a row
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
