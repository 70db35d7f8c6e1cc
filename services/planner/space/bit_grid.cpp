#include "services/planner/space/bit_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

using Word = std::uint64_t;

/// One cell to either side. The words before the first and behind the last one are read, too.
LUMINAV_VECTOR_CLONES
void widen(const Word* bits, std::size_t words, Word* result) {
  const auto end = static_cast<std::ptrdiff_t>(words);  // signed: the first reads the word before it
#pragma GCC ivdep
  for (std::ptrdiff_t i = 0; i < end; ++i) {
    result[i] = bits[i] | bits[i] << 1 | bits[i] >> 1 | bits[i - 1] >> 63 | bits[i + 1] << 63;
  }
}

LUMINAV_VECTOR_CLONES
void unite(const Word* bits, std::size_t words, Word* result) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < words; ++i) {
    result[i] |= bits[i];
  }
}

/// Rows of a disc, counted from its middle, by how much wider the widest is to either side.
std::vector<std::vector<int>> rows_by_width(double radius) {
  const int reach = static_cast<int>(std::floor(std::sqrt(radius * radius + 1e-6)));  // as the widths below
  std::vector<std::vector<int>> rows(static_cast<std::size_t>(reach) + 1);
  for (int row = -reach; row <= reach; ++row) {
    const int half_width = static_cast<int>(std::floor(std::sqrt(radius * radius + 1e-6 - row * row)));
    rows[static_cast<std::size_t>(reach - half_width)].push_back(row);
  }
  return rows;
}

}  // namespace

std::int64_t BitGrid::count() const {
  std::int64_t bits = 0;
  for (const Word word : words_) {
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
    const Word* left = a.row(row);
    const Word* right = b.row(row);
    if (std::equal(left, left + a.words_per_row(), right)) {
      continue;
    }
    window.first_row = std::min(window.first_row, row);
    window.last_row = row + 1;
    for (std::size_t i = 0; i < a.words_per_row(); ++i) {
      const Word changed = left[i] ^ right[i];
      if (changed != 0) {
        const int column = static_cast<int>(64 * i);
        window.first_column = std::min(window.first_column, column + std::countr_zero(changed));
        window.last_column = std::max(window.last_column, column + 64 - std::countl_zero(changed));
      }
    }
  }
  return window;
}

// What is as wide as the widest row of the disc is united and widened once, then what is one narrower is added, and so
// on (Horner's scheme), over as many rows at once as stay in the cache. What is widened beyond a row's end stays in the
// word behind it.
void dilate(const BitGrid& solid, double radius, int first_row, int last_row, BitGrid& result) {
  if (!(radius >= 0.0 && radius < 63.0)) {
    throw std::invalid_argument("dilate: the radius must be between 0 and 63 cells");
  }
  if (solid.columns() == 0) {
    return;
  }
  constexpr std::size_t kWordsAtOnce = 1200;
  const std::size_t stride = solid.stride();
  const int rows_at_once = static_cast<int>(std::max<std::size_t>(1, kWordsAtOnce / stride));
  const std::vector<std::vector<int>> rows = rows_by_width(radius);
  const int past = solid.columns() % 64;
  const Word inside = past == 0 ? ~Word{0} : (Word{1} << past) - 1;
  const std::size_t max_words = stride * static_cast<std::size_t>(rows_at_once);
  std::vector<Word> one(max_words + 2, 0);  // with a word of 0 before the first and behind the last
  std::vector<Word> other(max_words + 2, 0);
  for (int first = first_row; first < last_row; first += rows_at_once) {
    const int last = std::min(first + rows_at_once, last_row);
    const std::size_t words = stride * static_cast<std::size_t>(last - first);
    Word* const target = result.row(first);
    Word* now = one.data() + 1;
    Word* next = other.data() + 1;
    std::fill_n(rows.size() == 1 ? target : now, words, Word{0});
    for (std::size_t k = 0; k < rows.size(); ++k) {
      if (k > 0) {
        std::swap(now, next);
        widen(next, words, k + 1 == rows.size() ? target : now);
      }
      Word* const united = k + 1 == rows.size() ? target : now;
      for (const int row : rows[k]) {
        const int from = std::max(first + row, 0);
        const int to = std::min(last + row, solid.rows());
        if (from < to) {
          unite(solid.row(from), stride * static_cast<std::size_t>(to - from),
                united + stride * static_cast<std::size_t>(from - row - first));
        }
      }
    }
    for (int row = first; row < last; ++row) {
      Word* const bits = result.row(row);
      bits[stride - 2] &= inside;
      bits[stride - 1] = 0;
    }
  }
}

}  // namespace luminav
