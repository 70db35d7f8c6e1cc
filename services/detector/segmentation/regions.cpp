#include "services/detector/segmentation/regions.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

std::size_t words_of(const Raster& image) {
  return static_cast<std::size_t>(image.width + 63) / 64;
}

/// Bit i of the result is the lowest bit of byte i: the multiplication moves all eight into the highest byte.
std::uint64_t gather_bits(std::uint64_t ones) {
  return (ones * 0x0102040810204080ULL) >> 56;
}

/// One bit for each pixel of some rows, 64 in a word, the first of a row in the lowest: set where the grey level is
/// above `level`; what is left of a row's last word is 0. In `bits` the rows begin `apart` words from each other.
LUMINAV_VECTOR_CLONES
void take_row_bits(const std::uint8_t* pixels, int width, int rows, int level, std::uint64_t* bits, std::size_t apart) {
  alignas(32) std::array<std::uint8_t, 64> ones;
  const auto floor = static_cast<std::uint8_t>(std::clamp(level, 0, 255));
  for (int y = 0; y < rows; ++y, pixels += width, bits += apart) {
    for (int x = 0; x < width; x += 64) {
      const int count = std::min(64, width - x);
      if (count == 64) {
#pragma GCC ivdep
        for (std::size_t i = 0; i < 64; ++i) {
          ones[i] = pixels[static_cast<std::size_t>(x) + i] > floor ? 1 : 0;
        }
      } else {
        ones.fill(0);
        for (int i = 0; i < count; ++i) {
          ones[static_cast<std::size_t>(i)] = pixels[x + i] > floor ? 1 : 0;
        }
      }
      std::uint64_t word = 0;
      for (std::size_t k = 0; k < 8; ++k) {
        std::uint64_t eight = 0;
        std::memcpy(&eight, ones.data() + 8 * k, 8);
        word |= gather_bits(eight) << (8 * k);
      }
      bits[x / 64] = word;
    }
  }
}

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
    from.joined_to = first;
  }
  return first;
}

void RegionFinder::take_bits(const Raster& image, const Cut& cut) {
  const std::size_t words = words_of(image);
  bits_.resize(words * static_cast<std::size_t>(image.height));
  take_row_bits(image.row(0), image.width, image.height, cut.level, bits_.data(), words);
}

void RegionFinder::erode_bits(const Raster& image) {
  const std::size_t words = words_of(image);
  const auto rows = static_cast<std::size_t>(image.height);
  eroded_.resize(words * rows);
  for (std::size_t y = 0; y < rows; ++y) {
    const std::uint64_t* above = &bits_[words * (y == 0 ? 0 : y - 1)];
    const std::uint64_t* here = &bits_[words * y];
    const std::uint64_t* below = &bits_[words * std::min(y + 1, rows - 1)];
    const auto in_all_three = [&](std::size_t i) { return above[i] & here[i] & below[i]; };
    std::uint64_t before = ~std::uint64_t{0};  // beyond the border
    std::uint64_t word = in_all_three(0);
    for (std::size_t i = 0; i < words; ++i) {
      const bool is_last = i + 1 == words;
      const std::uint64_t after = is_last ? 0 : in_all_three(i + 1);
      const std::uint64_t beyond = is_last ? std::uint64_t{1} << (image.width - 1) % 64 : 0;
      eroded_[words * y + i] = word & (word << 1 | before >> 63) & (word >> 1 | after << 63 | beyond);
      before = word;
      word = after;
    }
  }
  bits_.swap(eroded_);
}

void RegionFinder::take_runs(const Raster& image, const Cut& cut) {
  runs_.clear();
  part_of_run_.clear();
  parts_.clear();
  take_bits(image, cut);
  if (cut.is_eroded) {
    erode_bits(image);
  }
  const std::span<const std::uint64_t> bits(bits_);
  const std::size_t words = words_of(image);
  std::size_t above = 0;  // first run of the row above that may touch
  std::size_t above_end = 0;
  for (int y = 0; y < image.height; ++y) {
    const std::size_t row_begin = runs_.size();
    for_each_run(bits.subspan(words * static_cast<std::size_t>(y), words), image.width, [&](int first, int last) {
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
        parts_.push_back({.joined_to = part});
      }
      Part& own = parts_[static_cast<std::size_t>(part)];
      own.cells += last - first + 1;
      ++own.runs;
      runs_.push_back({y, first, last});
      part_of_run_.push_back(part);
    });
    above = row_begin;
    above_end = runs_.size();
  }
}

const std::vector<Region>& RegionFinder::find(const Raster& image, int min_cells, const Cut& cut) {
  take_runs(image, cut);
  regions_.clear();
  runs_by_region_.resize(runs_.size());
  std::size_t taken = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Part& part = parts_[i];
    if (part.joined_to != static_cast<int>(i) || part.cells < min_cells) {
      continue;
    }
    part.region = static_cast<int>(regions_.size());
    const int beyond = image.width + image.height;
    regions_.push_back({.cells = part.cells,
                        .left = beyond,
                        .right = -1,
                        .top = beyond,
                        .bottom = -1,
                        .runs = std::span(runs_by_region_).subspan(taken, static_cast<std::size_t>(part.runs))});
    part.next_run = taken;
    taken += static_cast<std::size_t>(part.runs);
  }
  for (std::size_t i = 0; i < runs_.size() && taken > 0; ++i) {
    Part& part = parts_[static_cast<std::size_t>(root(part_of_run_[i]))];
    if (part.region < 0) {
      continue;
    }
    const Run& run = runs_[i];
    runs_by_region_[part.next_run++] = run;
    Region& region = regions_[static_cast<std::size_t>(part.region)];
    region.left = std::min(region.left, run.first);
    region.right = std::max(region.right, run.last);
    region.top = std::min(region.top, run.row);
    region.bottom = run.row;
  }
  return regions_;
}

}  // namespace luminav
