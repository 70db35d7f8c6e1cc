#pragma once

#include <span>
#include <vector>

#include "services/detector/sampling/raster.hpp"

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

/// Finds the connected parts of a mask from their runs: the cost follows the number of runs, not of cells.
class RegionFinder {
 public:
  /// Parts of at least `min_cells` cells of what is 255 and not 0; valid until the next call.
  const std::vector<Region>& find(const Raster& mask, int min_cells);

 private:
  /// What is connected as far as the rows above tell; parts that prove to be one are joined to the first of them.
  struct Part {
    int joined_to = 0;  // itself: not to another
    int cells = 0;
    int runs = 0;
    int left = 0;
    int right = 0;
    int top = 0;
    int bottom = 0;
    bool is_region = false;    // else it is too small
    std::size_t next_run = 0;  // of the region, to be filled in
  };
  void take_runs(const Raster& mask);
  int root(int part);
  int join(int a, int b);

  std::vector<Run> runs_;
  std::vector<int> part_of_run_;
  std::vector<Part> parts_;
  std::vector<Run> runs_by_region_;  // region after region
  std::vector<Region> regions_;
};

}  // namespace luminav
