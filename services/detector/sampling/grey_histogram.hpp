#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace luminav {

/// How often each grey level occurs.
class GreyHistogram {
 public:
  /// Counts every `step`-th of the cells.
  explicit GreyHistogram(std::span<const std::uint8_t> cells, std::size_t step = 1);

  /// The lowest level that at least half of the cells do not exceed; 0 of none.
  [[nodiscard]] int median() const;
  [[nodiscard]] double share_from(int level) const;  // of the cells that are at least as bright
  /// The median, linear within its level.
  [[nodiscard]] double interpolated_median() const;

 private:
  std::array<int, 256> counts_{};
  int total_ = 0;
};

}  // namespace luminav
