#include "services/detector/regions.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

namespace luminav {
namespace {

static_assert(std::endian::native == std::endian::little);  // the first of eight cells is the lowest byte

std::uint64_t eight_cells(const std::uint8_t* cells) {
  std::uint64_t eight;
  std::memcpy(&eight, cells, sizeof eight);
  return eight;
}

/// First cell at or after `x` that is set (or not set), `width` when there is none. Masks are mostly empty, so empty
/// stretches are crossed many cells at a time.
int next_set(const std::uint8_t* row, int x, int width) {
  while (x + 32 <= width) {
    const std::uint8_t* many = row + x;
    if ((eight_cells(many) | eight_cells(many + 8) | eight_cells(many + 16) | eight_cells(many + 24)) != 0) {
      break;
    }
    x += 32;
  }
  for (; x + 8 <= width; x += 8) {
    if (const std::uint64_t eight = eight_cells(row + x); eight != 0) {
      return x + std::countr_zero(eight) / 8;
    }
  }
  while (x < width && row[x] == 0) {
    ++x;
  }
  return x;
}

int next_clear(const std::uint8_t* row, int x, int width) {
  constexpr std::uint64_t kOnes = 0x0101010101010101;
  for (; x + 8 <= width; x += 8) {
    const std::uint64_t eight = eight_cells(row + x);
    // the lowest bit that is left stands in the first empty cell (Mycroft 1987)
    if (const std::uint64_t clear = (eight - kOnes) & ~eight & (kOnes << 7); clear != 0) {
      return x + std::countr_zero(clear) / 8;
    }
  }
  while (x < width && row[x] != 0) {
    ++x;
  }
  return x;
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

const std::vector<Region>& RegionFinder::find(const Raster& mask, int least_cells, const FilledRows& filled) {
  runs_.clear();
  parent_.clear();
  int above = 0;  // first run of the row above that may touch
  int above_end = 0;
  for (int y = 0; y < mask.height; ++y) {
    const int row_begin = static_cast<int>(runs_.size());
    const std::uint8_t* row = mask.row(y);
    for (int x = filled.may_be(y) ? next_set(row, 0, mask.width) : mask.width; x < mask.width;
         x = next_set(row, x, mask.width)) {
      const int end = next_clear(row, x, mask.width);
      const int current = static_cast<int>(runs_.size());
      runs_.push_back({y, x, end - 1});
      parent_.push_back(current);
      while (above < above_end && runs_[static_cast<std::size_t>(above)].last < x - 1) {
        ++above;
      }
      for (int other = above; other < above_end && runs_[static_cast<std::size_t>(other)].first <= end; ++other) {
        const int a = root(other);
        const int b = root(current);
        parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      }
      x = end;
    }
    above = row_begin;
    above_end = static_cast<int>(runs_.size());
  }

  const std::size_t count = runs_.size();
  cells_.assign(count, 0);
  run_counts_.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const auto top = static_cast<std::size_t>(root(static_cast<int>(i)));
    cells_[top] += runs_[i].last - runs_[i].first + 1;
    ++run_counts_[top];
  }
  regions_.clear();
  runs_end_.clear();
  runs_by_region_.resize(count);
  region_of_root_.assign(count, -1);
  std::size_t taken = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto top = static_cast<std::size_t>(root(static_cast<int>(i)));
    if (cells_[top] < least_cells) {
      continue;
    }
    if (region_of_root_[top] < 0) {
      region_of_root_[top] = static_cast<int>(regions_.size());
      const auto run_count = static_cast<std::size_t>(run_counts_[top]);
      const int beyond = mask.width + mask.height;
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
