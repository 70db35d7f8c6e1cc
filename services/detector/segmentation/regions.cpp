#include "services/detector/segmentation/regions.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace luminav {
namespace {

/// Calls `take` with the first and the last place of every run of 255s.
template <typename Take>
void for_each_run(std::span<const std::uint8_t> mask, Take take) {
  const auto find_from = [&](std::size_t from, int value) {
    const void* found = std::memchr(mask.data() + from, value, mask.size() - from);
    return found == nullptr ? mask.size()
                            : static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - mask.data());
  };
  for (std::size_t end = 0; end < mask.size();) {
    const std::size_t first = find_from(end, 255);
    end = find_from(first, 0);
    if (first < end) {
      take(static_cast<int>(first), static_cast<int>(end) - 1);
    }
  }
}

}  // namespace

int RegionFinder::root(int part) {
  while (parts_[static_cast<std::size_t>(part)].joined_to != part) {
    const int above = parts_[static_cast<std::size_t>(part)].joined_to;
    parts_[static_cast<std::size_t>(part)].joined_to = parts_[static_cast<std::size_t>(above)].joined_to;
    part = above;
  }
  return part;
}

int RegionFinder::join(int a, int b) {
  const int first = std::min(a, b);
  const int other = std::max(a, b);
  if (first != other) {
    Part& into = parts_[static_cast<std::size_t>(first)];
    Part& from = parts_[static_cast<std::size_t>(other)];
    into.cells += from.cells;
    into.runs += from.runs;
    into.left = std::min(into.left, from.left);
    into.right = std::max(into.right, from.right);
    into.bottom = std::max(into.bottom, from.bottom);
    from.joined_to = first;
  }
  return first;
}

void RegionFinder::take_runs(const Raster& mask) {
  runs_.clear();
  part_of_run_.clear();
  parts_.clear();
  std::size_t above = 0;  // first run of the row above that may touch
  std::size_t above_end = 0;
  for (int y = 0; y < mask.rows; ++y) {
    const std::size_t row_begin = runs_.size();
    for_each_run({mask[y], static_cast<std::size_t>(mask.cols)}, [&](int first, int last) {
      while (above < above_end && runs_[above].last < first - 1) {
        ++above;
      }
      int part = -1;
      for (std::size_t other = above; other < above_end && runs_[other].first <= last + 1; ++other) {
        const int touched = root(part_of_run_[other]);
        part = part < 0 ? touched : join(part, touched);
      }
      if (part < 0) {
        part = static_cast<int>(parts_.size());
        parts_.push_back({.joined_to = part, .left = first, .right = last, .top = y});
      }
      Part& own = parts_[static_cast<std::size_t>(part)];
      own.cells += last - first + 1;
      ++own.runs;
      own.left = std::min(own.left, first);
      own.right = std::max(own.right, last);
      own.bottom = y;
      runs_.push_back({y, first, last});
      part_of_run_.push_back(part);
    });
    above = row_begin;
    above_end = runs_.size();
  }
}

const std::vector<Region>& RegionFinder::find(const Raster& mask, int min_cells) {
  take_runs(mask);
  regions_.clear();
  runs_by_region_.resize(runs_.size());
  std::size_t taken = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Part& part = parts_[i];
    if (part.joined_to != static_cast<int>(i) || part.cells < min_cells) {
      continue;
    }
    part.is_region = true;
    regions_.push_back({part.cells, part.left, part.right, part.top, part.bottom,
                        std::span(runs_by_region_).subspan(taken, static_cast<std::size_t>(part.runs))});
    part.next_run = taken;
    taken += static_cast<std::size_t>(part.runs);
  }
  for (std::size_t i = 0; i < runs_.size() && taken > 0; ++i) {
    Part& part = parts_[static_cast<std::size_t>(root(part_of_run_[i]))];
    if (part.is_region) {
      runs_by_region_[part.next_run++] = runs_[i];
    }
  }
  return regions_;
}

}  // namespace luminav
