#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// Poses by squares of 1 m, numbered as they were added: who looks for near ones asks only those of nine squares, so
/// that sorting out doubles stays linear in their number.
class PoseHash {
 public:
  /// For at most `max` poses.
  explicit PoseHash(std::size_t max) : heads_(std::bit_ceil(2 * max + 1), -1) { places_.reserve(max); }

  void add(const Pose2& pose) {
    const auto [column, row] = square_of(pose);
    int& head = heads_[slot_of(column, row)];
    places_.push_back({column, row, head});
    head = static_cast<int>(places_.size()) - 1;
  }

  /// Whether the test holds for the number of any pose in the square of `pose` or one beside it.
  template <typename Test>
  [[nodiscard]] bool any_near(const Pose2& pose, const Test& test) const {
    const auto [column, row] = square_of(pose);
    for (std::int64_t c = column - 1; c <= column + 1; ++c) {
      for (std::int64_t r = row - 1; r <= row + 1; ++r) {
        for (int i = heads_[slot_of(c, r)]; i >= 0; i = places_[static_cast<std::size_t>(i)].next) {
          const Place& place = places_[static_cast<std::size_t>(i)];
          if (place.column == c && place.row == r && test(static_cast<std::size_t>(i))) {
            return true;
          }
        }
      }
    }
    return false;
  }

 private:
  struct Place {
    std::int64_t column;
    std::int64_t row;
    int next;  // with the same slot, -1 = none
  };

  static std::array<std::int64_t, 2> square_of(const Pose2& pose) {
    return {static_cast<std::int64_t>(std::floor(pose.x)), static_cast<std::int64_t>(std::floor(pose.y))};
  }
  [[nodiscard]] std::size_t slot_of(std::int64_t column, std::int64_t row) const {
    return static_cast<std::size_t>(31 * column + row) & (heads_.size() - 1);  // neighbours in slots of their own
  }

  std::vector<int> heads_;  // newest of each slot, -1 = none
  std::vector<Place> places_;
};

}  // namespace luminav
