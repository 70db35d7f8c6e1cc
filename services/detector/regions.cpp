#include "services/detector/regions.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "services/detector/row_bits.hpp"

namespace luminav {
namespace {

/// Calls `take` with both ends of every run of set bits of a row.
template <typename Take>
void for_each_run(std::span<const std::uint64_t> bits, int width, Take take) {
  std::uint64_t before = 0;  // whether the bit before the word is set
  int first = 0;
  for (std::size_t i = 0; i < bits.size(); ++i) {
    const std::uint64_t word = bits[i];
    // set where a run begins and behind its end
    for (std::uint64_t changes = word ^ (word << 1 | before); changes != 0; changes &= changes - 1) {
      const int bit = std::countr_zero(changes);
      const int x = 64 * static_cast<int>(i) + bit;
      if ((word >> bit & 1) != 0) {
        first = x;
      } else {
        take(first, x - 1);
      }
    }
    before = word >> 63;
  }
  if (before != 0) {
    take(first, width - 1);
  }
}

}  // namespace

int RegionFinder::root(int run) {
  while (parent_[static_cast<std::size_t>(run)] != run) {
    const int above = parent_[static_cast<std::size_t>(run)];
    parent_[static_cast<std::size_t>(run)] = parent_[static_cast<std::size_t>(above)];
    run = above;
  }
  return run;
}

void RegionFinder::take_runs(const Raster& image, const Cut& cut) {
  runs_.clear();
  parent_.clear();
  bits_.resize(static_cast<std::size_t>(image.width + 63) / 64);
  std::size_t above = 0;  // first run of the row above that may touch
  std::size_t above_end = 0;
  for (int y = 0; y < image.height; ++y) {
    const std::size_t row_begin = runs_.size();
    if (cut.may_be_in(y)) {
      take_row_bits(image.row(y), image.width, cut.level, -1, bits_.data());
      for_each_run(bits_, image.width, [&](int first, int last) {
        const int current = static_cast<int>(runs_.size());
        runs_.push_back({y, first, last});
        parent_.push_back(current);
        while (above < above_end && runs_[above].last < first - 1) {
          ++above;
        }
        for (std::size_t other = above; other < above_end && runs_[other].first <= last + 1; ++other) {
          const int a = root(static_cast<int>(other));
          const int b = root(current);
          parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
        }
      });
    }
    above = row_begin;
    above_end = runs_.size();
  }
}

const std::vector<Region>& RegionFinder::find(const Raster& image, int least_cells, const Cut& cut) {
  take_runs(image, cut);
  const std::size_t count = runs_.size();
  cells_.assign(count, 0);
  run_counts_.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const int top_run = root(static_cast<int>(i));
    parent_[i] = top_run;
    const auto top = static_cast<std::size_t>(top_run);
    cells_[top] += runs_[i].last - runs_[i].first + 1;
    ++run_counts_[top];
  }
  regions_.clear();
  runs_end_.clear();
  runs_by_region_.resize(count);
  region_of_root_.assign(count, -1);
  std::size_t taken = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto top = static_cast<std::size_t>(parent_[i]);
    if (cells_[top] < least_cells) {
      continue;
    }
    if (region_of_root_[top] < 0) {
      region_of_root_[top] = static_cast<int>(regions_.size());
      const auto run_count = static_cast<std::size_t>(run_counts_[top]);
      const int beyond = image.width + image.height;
      regions_.push_back({.cells = cells_[top],
                          .left = beyond,
                          .right = -1,
                          .top = beyond,
                          .bottom = -1,
                          .runs = std::span(runs_by_region_).subspan(taken, run_count)});
      runs_end_.push_back(taken);
      taken += run_count;
    }
    const auto index = static_cast<std::size_t>(region_of_root_[top]);
    Region& region = regions_[index];
    const Run& run = runs_[i];
    runs_by_region_[runs_end_[index]++] = run;
    region.left = std::min(region.left, run.first);
    region.right = std::max(region.right, run.last);
    region.top = std::min(region.top, run.row);
    region.bottom = std::max(region.bottom, run.row);
  }
  return regions_;
}

}  // namespace luminav
