#include "services/planner/bit_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

/// One cell to either side. Both arrays have a word of 0 before the first and behind the last one.
LUMINAV_VECTOR_CLONES
void widen(const std::uint64_t* bits, std::size_t words, std::uint64_t* result) {
  for (std::size_t i = 0; i < words; ++i) {
    result[i] = bits[i] | bits[i] << 1 | bits[i] >> 1 | bits[i - 1] >> 63 | bits[i + 1] << 63;
  }
}

LUMINAV_VECTOR_CLONES
void unite(const std::uint64_t* bits, std::size_t words, std::uint64_t* result) {
  for (std::size_t i = 0; i < words; ++i) {
    result[i] |= bits[i];
  }
}

}  // namespace

std::int64_t BitGrid::count() const {
  std::int64_t bits = 0;
  for (const std::uint64_t word : words_) {
    bits += std::popcount(word);
  }
  return bits;
}

CellWindow CellWindow::grown(int cells, int columns, int rows) const {
  return {std::max(0, first_column - cells), std::min(columns, last_column + cells), std::max(0, first_row - cells),
          std::min(rows, last_row + cells)};
}

CellWindow difference(const BitGrid& a, const BitGrid& b) {
  CellWindow window{a.columns(), 0, a.rows(), 0};
  for (int row = 0; row < a.rows(); ++row) {
    const std::uint64_t* left = a.row(row);
    const std::uint64_t* right = b.row(row);
    if (std::equal(left, left + a.words_per_row(), right)) {
      continue;
    }
    window.first_row = std::min(window.first_row, row);
    window.last_row = row + 1;
    for (std::size_t i = 0; i < a.words_per_row(); ++i) {
      const std::uint64_t changed = left[i] ^ right[i];
      if (changed != 0) {
        const int column = static_cast<int>(64 * i);
        window.first_column = std::min(window.first_column, column + std::countr_zero(changed));
        window.last_column = std::max(window.last_column, column + 64 - std::countl_zero(changed));
      }
    }
  }
  return window;
}

void dilate(const BitGrid& solid, double radius, int first_row, int last_row, BitGrid& result) {
  const int reach = static_cast<int>(std::floor(radius + 1e-9));
  std::vector<int> half_width;  // of the disc, by rows from its middle
  for (int dr = 0; dr <= reach; ++dr) {
    half_width.push_back(static_cast<int>(std::floor(std::sqrt(radius * radius + 1e-6 - dr * dr))));
  }
  const std::size_t words = solid.words_per_row();
  const int past = solid.columns() % 64;
  const std::uint64_t inside = past == 0 ? ~std::uint64_t{0} : (std::uint64_t{1} << past) - 1;
  for (int row = first_row; row < last_row; ++row) {
    std::fill(result.row(row), result.row(row) + words, std::uint64_t{0});
  }
  std::vector<std::uint64_t> narrow(words + 2, 0);
  std::vector<std::uint64_t> wide(words + 2, 0);
  for (int row = std::max(0, first_row - reach); row < std::min(solid.rows(), last_row + reach); ++row) {
    const std::uint64_t* source = solid.row(row);
    if (std::all_of(source, source + words, [](std::uint64_t word) { return word == 0; })) {
      continue;
    }
    // the row itself, then ever wider; each goes to the rows where the disc is that wide
    std::copy(source, source + words, narrow.begin() + 1);
    for (int width = 0; width <= reach; ++width) {
      for (int dr = reach; dr >= 0; --dr) {
        if (half_width[static_cast<std::size_t>(dr)] != width) {
          continue;
        }
        if (row - dr >= first_row && row - dr < last_row) {
          unite(narrow.data() + 1, words, result.row(row - dr));
        }
        if (dr != 0 && row + dr >= first_row && row + dr < last_row) {
          unite(narrow.data() + 1, words, result.row(row + dr));
        }
      }
      if (width < reach) {
        widen(narrow.data() + 1, words, wide.data() + 1);
        wide[words] &= inside;
        narrow.swap(wide);
      }
    }
  }
}

}  // namespace luminav
