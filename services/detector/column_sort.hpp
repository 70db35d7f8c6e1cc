#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace luminav {

/// Sorts each column of a table by itself; there are no numbers that are none in it. The exchanges do not depend on the
/// values, so one instruction makes those of many columns (odd-even merges; Batcher 1968; Knuth 5.2.2, algorithm M).
void sort_columns(std::span<std::array<float, 8>> rows);
void sort_columns(std::span<std::array<float, 16>> rows);

}  // namespace luminav
