#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// Rows [first, last) and columns [first, last) of a grid.
struct CellWindow {
  int first_column = 0;
  int last_column = 0;
  int first_row = 0;
  int last_row = 0;

  [[nodiscard]] bool is_empty() const { return first_column >= last_column || first_row >= last_row; }
  /// Grown by some cells to all sides, clipped to a grid.
  [[nodiscard]] CellWindow grown(int cells, int columns, int rows) const;
};

/// One bit per cell, row-major, each row in words of its own with the lowest column in the lowest bit: an eighth of the
/// memory of bytes, and 64 cells an operation. Bits beyond the last column are always 0, and so is one more word behind
/// each row, so that what shifts bits over many rows at once takes none from one row into the next.
class BitGrid {
 public:
  BitGrid() = default;
  BitGrid(int columns, int rows)
      : columns_(columns),
        rows_(rows),
        words_per_row_(static_cast<std::size_t>(columns + 63) / 64),
        words_(stride() * static_cast<std::size_t>(rows), 0) {}

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] std::size_t words_per_row() const { return words_per_row_; }
  /// Words from one row to the next.
  [[nodiscard]] std::size_t stride() const { return words_per_row_ + 1; }
  [[nodiscard]] std::uint64_t* row(int row) { return words_.data() + static_cast<std::size_t>(row) * stride(); }
  [[nodiscard]] const std::uint64_t* row(int row) const {
    return words_.data() + static_cast<std::size_t>(row) * stride();
  }
  /// The cell must lie inside.
  [[nodiscard]] bool test(const Cell& cell) const {
    return (row(cell.row)[static_cast<std::size_t>(cell.column) / 64] >> (cell.column % 64) & 1U) != 0;
  }
  void set(const Cell& cell) {
    row(cell.row)[static_cast<std::size_t>(cell.column) / 64] |= std::uint64_t{1} << (cell.column % 64);
  }
  /// True if all cells are set of a window that is at most 64 columns wide and lies inside.
  [[nodiscard]] bool has_all(const CellWindow& window) const {
    const std::size_t word = static_cast<std::size_t>(window.first_column) / 64;
    const int shift = window.first_column % 64;
    const std::uint64_t wanted = ~std::uint64_t{0} >> (64 - (window.last_column - window.first_column));
    std::uint64_t missing = 0;
    for (int r = window.first_row; r < window.last_row; ++r) {
      const std::uint64_t* words = row(r) + word;
      missing |= ~(words[0] >> shift | words[1] << 1 << (63 - shift)) & wanted;
    }
    return missing == 0;
  }
  [[nodiscard]] std::int64_t count() const;
  friend bool operator==(const BitGrid&, const BitGrid&) = default;

 private:
  int columns_ = 0;
  int rows_ = 0;
  std::size_t words_per_row_ = 0;
  std::vector<std::uint64_t> words_;
};

/// The smallest window with all bits in which two grids of one size differ; empty when they are the same.
CellWindow difference(const BitGrid& a, const BitGrid& b);

/// Every cell whose centre lies within `radius` [cells] of the centre of a cell that is set, the exact disc; only rows
/// [first_row, last_row) of the result are written. Throws std::invalid_argument unless the radius is below 63 cells.
void dilate(const BitGrid& solid, double radius, int first_row, int last_row, BitGrid& result);

}  // namespace luminav
