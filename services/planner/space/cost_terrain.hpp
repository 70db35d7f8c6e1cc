#pragma once

#include <cstddef>
#include <cstdint>

#include "services/planner/space/bit_grid.hpp"

namespace luminav {

/// Which cells a search may enter and at what price: price 1 to 36 by a cell's class, or one price for all. Refers to
/// arrays that must outlive it. The outermost ring of cells must not be passable.
struct CostTerrain {
  const BitGrid* passable = nullptr;
  const std::uint8_t* classes = nullptr;      // per cell, row-major; nullptr = the same price everywhere
  const std::uint8_t* class_price = nullptr;  // 256 of them; with no classes only the first counts
  const std::uint8_t* forbidden = nullptr;    // per cell, as `LaneMap` has it; nullptr = every step is allowed

  [[nodiscard]] int columns() const { return passable->columns(); }
  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(passable->columns()) * static_cast<std::size_t>(passable->rows());
  }
  [[nodiscard]] std::uint32_t price(std::size_t cell) const {
    return class_price[classes == nullptr ? 0 : classes[cell]];
  }
  /// True if the i-th of `grid_steps` may lead from one cell to the next.
  [[nodiscard]] bool allows(std::size_t from, std::size_t to, std::size_t i) const {
    return forbidden == nullptr || ((forbidden[from] | forbidden[to]) >> i & 1) == 0;
  }
};

/// A cell that has another price now, or became passable or blocked.
struct PriceChange {
  std::uint32_t cell = 0;
  std::uint8_t price_before = 0;  // 0 = blocked
};

}  // namespace luminav
