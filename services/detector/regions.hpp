#pragma once

#include <cstdint>
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
  std::vector<Run> runs;  // from the top
};

/// Finds the connected parts of a mask from its runs: the cost follows the number of runs, not of cells.
class RegionFinder {
 public:
  /// Parts of at least `least_cells` cells; valid until the next call.
  const std::vector<Region>& find(const Raster& mask, int least_cells);

 private:
  int root(int run);

  std::vector<Run> runs_;
  std::vector<int> parent_;
  std::vector<int> region_of_root_;
  std::vector<int> cells_;
  std::vector<Region> regions_;
  std::vector<Region> spare_;  // keep their memory from frame to frame
};

}  // namespace luminav
