#include "services/planner/distance_field.hpp"

#include <algorithm>
#include <cstddef>

namespace luminav {
namespace {

constexpr std::uint8_t kFar = kDistanceReach + 1;  // vertical distance when nothing is in reach

std::uint8_t add_saturated(std::uint8_t a, std::uint8_t b) {
  const auto sum = static_cast<std::uint8_t>(a + b);
  return sum < a ? kNothingNear : sum;
}

/// Distances along the columns of a window, [cells], capped at kFar.
void vertical_distances(const std::vector<std::uint8_t>& solid, std::size_t stride, std::size_t first,
                        std::size_t width, std::size_t first_row, std::size_t last_row,
                        std::vector<std::uint8_t>& down) {
  const std::size_t height = last_row - first_row;
  down.resize(width * height);
  for (std::size_t row = 0; row < height; ++row) {
    const std::uint8_t* source = solid.data() + (first_row + row) * stride + first;
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

void update_squared_distances(const std::vector<std::uint8_t>& solid, int columns, int rows, int first_column,
                              int last_column, int first_row, int last_row, std::vector<std::uint8_t>& result) {
  // what counts may lie a reach outside the window
  const auto from_column = static_cast<std::size_t>(std::max(0, first_column - kDistanceReach));
  const auto to_column = static_cast<std::size_t>(std::min(columns, last_column + kDistanceReach));
  const auto from_row = static_cast<std::size_t>(std::max(0, first_row - kDistanceReach));
  const auto to_row = static_cast<std::size_t>(std::min(rows, last_row + kDistanceReach));
  const auto stride = static_cast<std::size_t>(columns);
  const std::size_t width = to_column - from_column;
  if (width == 0 || to_row <= from_row) {
    return;
  }
  std::vector<std::uint8_t> vertical;
  vertical_distances(solid, stride, from_column, width, from_row, to_row, vertical);

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
    std::uint8_t* target = result.data() + static_cast<std::size_t>(row) * stride;
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

void squared_distances(const std::vector<std::uint8_t>& solid, int columns, int rows,
                       std::vector<std::uint8_t>& result) {
  result.resize(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  update_squared_distances(solid, columns, rows, 0, columns, 0, rows, result);
}

}  // namespace luminav
