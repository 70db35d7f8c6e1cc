#include "services/planner/space/distance_field.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace luminav {
namespace {

constexpr std::uint8_t kFar = kDistanceReach + 1;  // vertical distance when nothing is in reach

std::uint8_t add_saturated(std::uint8_t a, std::uint8_t b) {
  const auto sum = static_cast<std::uint8_t>(a + b);
  return sum < a ? kNothingNear : sum;
}

/// Eight bits as eight bytes of 0 or 1.
std::uint64_t spread(std::uint64_t bits) {
  const std::uint64_t each = (bits & 0xFF) * 0x0101010101010101ULL & 0x8040201008040201ULL;
  return (each + 0x7F7F7F7F7F7F7F7FULL) >> 7 & 0x0101010101010101ULL;
}

/// Distances along the columns of a window, [cells], capped at kFar.
void vertical_distances(const BitGrid& solid, const CellWindow& window, std::vector<std::uint8_t>& down) {
  const auto first = static_cast<std::size_t>(window.first_column);
  const auto width = static_cast<std::size_t>(window.last_column - window.first_column);
  const auto height = static_cast<std::size_t>(window.last_row - window.first_row);
  const std::size_t first_byte = first / 8;
  const std::size_t last_byte = (first + width + 7) / 8;
  std::vector<std::uint8_t> bytes(8 * (last_byte - first_byte));
  const std::uint8_t* source = bytes.data() + first % 8;
  down.resize(width * height);
  for (std::size_t row = 0; row < height; ++row) {
    const std::uint64_t* words = solid.row(window.first_row + static_cast<int>(row));
    for (std::size_t byte = first_byte; byte < last_byte; ++byte) {
      const std::uint64_t eight = spread(words[byte / 8] >> (8 * (byte % 8)));
      std::memcpy(bytes.data() + 8 * (byte - first_byte), &eight, 8);
    }
    std::uint8_t* target = down.data() + row * width;
    const std::uint8_t* above = row == 0 ? nullptr : target - width;
    for (std::size_t i = 0; i < width; ++i) {
      const int before = above == nullptr ? kFar : above[i];
      target[i] = static_cast<std::uint8_t>(source[i] != 0 ? 0 : std::min<int>(before + 1, kFar));
    }
  }
  for (std::size_t row = height - 1; row-- > 0;) {
    std::uint8_t* target = down.data() + row * width;
    const std::uint8_t* below = target + width;
    for (std::size_t i = 0; i < width; ++i) {
      target[i] = static_cast<std::uint8_t>(std::min<int>(target[i], below[i] + 1));
    }
  }
}

}  // namespace

void update_squared_distances(const BitGrid& solid, const CellWindow& window, std::uint8_t* result) {
  // what counts may lie a reach outside the window
  const CellWindow around = window.grown(kDistanceReach, solid.columns(), solid.rows());
  if (window.is_empty() || around.is_empty()) {
    return;
  }
  const auto [first_column, last_column, first_row, last_row] = window;
  const auto stride = static_cast<std::size_t>(solid.columns());
  const auto from_column = static_cast<std::size_t>(around.first_column);
  const auto from_row = static_cast<std::size_t>(around.first_row);
  const auto width = static_cast<std::size_t>(around.last_column - around.first_column);
  std::vector<std::uint8_t> vertical;
  vertical_distances(solid, around, vertical);

  std::vector<std::uint8_t> squares(width + 2 * kDistanceReach, kNothingNear);
  std::vector<std::uint8_t> best(width);
  for (int row = first_row; row < last_row; ++row) {
    const std::uint8_t* line = vertical.data() + (static_cast<std::size_t>(row) - from_row) * width;
    std::uint8_t* middle = squares.data() + kDistanceReach;
    std::uint8_t nearest = kFar;
    for (std::size_t i = 0; i < width; ++i) {
      nearest = std::min(nearest, line[i]);
      middle[i] = line[i] >= kFar ? kNothingNear : static_cast<std::uint8_t>(line[i] * line[i]);
    }
    std::uint8_t* target = result + static_cast<std::size_t>(row) * stride;
    if (nearest >= kFar) {
      std::fill(target + first_column, target + last_column, kNothingNear);
      continue;
    }
    std::copy(middle, middle + width, best.begin());
    for (int offset = 1; offset <= kDistanceReach; ++offset) {
      const auto square = static_cast<std::uint8_t>(offset * offset);
      const std::uint8_t* left = middle - offset;
      const std::uint8_t* right = middle + offset;
      for (std::size_t i = 0; i < width; ++i) {
        best[i] = std::min(best[i], add_saturated(std::min(left[i], right[i]), square));
      }
    }
    const std::size_t skip = static_cast<std::size_t>(first_column) - from_column;
    std::copy(best.begin() + static_cast<std::ptrdiff_t>(skip),
              best.begin() + static_cast<std::ptrdiff_t>(skip) + (last_column - first_column), target + first_column);
  }
}

std::vector<std::uint8_t> squared_distances(const BitGrid& solid) {
  std::vector<std::uint8_t> result(static_cast<std::size_t>(solid.columns()) * static_cast<std::size_t>(solid.rows()));
  update_squared_distances(solid, {0, solid.columns(), 0, solid.rows()}, result.data());
  return result;
}

}  // namespace luminav
