#include "services/detector/column_sort.hpp"

#include <algorithm>
#include <bit>

#include "services/common/geometry/vector_clones.hpp"

namespace luminav {
namespace {

/// Numbers that one instruction works on, where the processor can.
constexpr std::size_t kLanes = 8;
using Eight [[gnu::vector_size(kLanes * sizeof(float))]] = float;
using EightInMemory [[gnu::vector_size(kLanes * sizeof(float)), gnu::aligned(4), gnu::may_alias]] = float;

[[gnu::always_inline]] inline void put_in_order(float* a, float* b) {
  EightInMemory* low = reinterpret_cast<EightInMemory*>(a);
  EightInMemory* high = reinterpret_cast<EightInMemory*>(b);
  const Eight x = *low;
  const Eight y = *high;
  *low = y < x ? y : x;
  *high = y < x ? x : y;
}

template <std::size_t kColumns>
[[gnu::always_inline]] inline void sort(float* table, std::size_t rows) {
  const std::size_t largest = std::bit_ceil(rows) / 2;
  for (std::size_t length = largest; length > 0; length /= 2) {
    std::size_t apart = length;
    std::size_t first = 0;
    for (std::size_t merged = largest;; merged /= 2) {
      // `length` rows in a row, then as many that are left alone
      for (std::size_t begin = first; begin + apart < rows; begin += 2 * length) {
        const std::size_t end = std::min(begin + length, rows - apart);
        for (std::size_t row = begin; row < end; ++row) {
          float* a = table + row * kColumns;
          for (std::size_t k = 0; k < kColumns; k += kLanes) {
            put_in_order(a + k, a + apart * kColumns + k);
          }
        }
      }
      if (merged == length) {
        break;
      }
      apart = merged - length;
      first = length;
    }
  }
}

LUMINAV_VECTOR_CLONES
void sort_eight(float* table, std::size_t rows) {
  sort<8>(table, rows);
}

LUMINAV_VECTOR_CLONES
void sort_sixteen(float* table, std::size_t rows) {
  sort<16>(table, rows);
}

}  // namespace

void sort_columns(std::span<std::array<float, 8>> rows) {
  if (rows.size() > 1) {
    sort_eight(rows.front().data(), rows.size());
  }
}

void sort_columns(std::span<std::array<float, 16>> rows) {
  if (rows.size() > 1) {
    sort_sixteen(rows.front().data(), rows.size());
  }
}

}  // namespace luminav
