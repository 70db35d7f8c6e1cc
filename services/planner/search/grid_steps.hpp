#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include "services/planner/search/cost_field.hpp"

namespace luminav {

inline constexpr std::uint32_t kStraight = 5;  // 5 and 7 stand for 1 and sqrt 2 within 1 %
inline constexpr std::uint32_t kDiagonal = 7;

/// A step to one of the eight neighbours: what it adds to the index of a cell, and its length.
struct GridStep {
  std::ptrdiff_t offset;
  std::uint32_t length;
};

/// In the order of `kLaneSteps`.
inline std::array<GridStep, 8> grid_steps(int columns) {
  const std::ptrdiff_t row = columns;
  return {{{1, kStraight},
           {-1, kStraight},
           {row, kStraight},
           {-row, kStraight},
           {row + 1, kDiagonal},
           {row - 1, kDiagonal},
           {-row + 1, kDiagonal},
           {-row - 1, kDiagonal}}};
}

inline std::size_t moved(std::size_t cell, std::ptrdiff_t offset) {
  return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(cell) + offset);
}

/// Cells of one cost. Room is made before, so that cells are written without asking.
class Bucket {
 public:
  [[nodiscard]] const std::uint32_t* cells() const { return cells_.get(); }
  [[nodiscard]] std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
  /// Where the next cells go: there is room for `more` of them.
  std::uint32_t* room_for(std::size_t more) {
    if (size_ + more > capacity_) {
      capacity_ = 2 * capacity_ + more + 64;
      auto larger = std::make_unique_for_overwrite<std::uint32_t[]>(capacity_);
      std::copy(cells_.get(), cells_.get() + size_, larger.get());
      cells_ = std::move(larger);
    }
    return cells_.get() + size_;
  }
  /// Cells were written up to here; returns how many.
  std::size_t take_to(const std::uint32_t* end) {
    const auto size = static_cast<std::size_t>(end - cells_.get());
    const std::size_t more = size - size_;
    size_ = size;
    return more;
  }

 private:
  std::unique_ptr<std::uint32_t[]> cells_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

/// What is still to be done with a cell when the front has come to a level, in the order in which it is done.
enum class PendingTask : std::uint32_t {
  kRaise = 0,   // it may have lost the neighbour that its cost came from
  kSettle = 1,  // it is unreached and may get this cost
  kSpread = 2,  // its neighbours have not been offered its cost
};

struct Pending {
  std::uint32_t level;
  PendingTask task;
  std::size_t cell;
};

inline constexpr int kPendingCellBits = 30;

/// One number, so that the entries' order is that of level, task and cell.
inline std::uint64_t pending_entry(std::uint32_t level, PendingTask task, std::size_t cell) {
  return std::uint64_t{level} << 32 | std::uint64_t{static_cast<std::uint32_t>(task)} << kPendingCellBits | cell;
}

inline Pending pending_of(std::uint64_t entry) {
  const auto low = static_cast<std::uint32_t>(entry);
  return {static_cast<std::uint32_t>(entry >> 32), static_cast<PendingTask>(low >> kPendingCellBits),
          low & ((1U << kPendingCellBits) - 1)};
}

/// Keeps the cells of a bucket as the beginning of what is beyond where growing was stopped.
inline void keep_pending(const Bucket& bucket, CostField& field) {
  for (std::size_t i = 0; i < bucket.size(); ++i) {
    const std::uint32_t cell = bucket.cells()[i];
    if (field.stored[cell] > field.settled_to) {  // else a cheaper path was found after it was queued
      field.pending.push_back(pending_entry(field.stored[cell], PendingTask::kSpread, cell));
    }
  }
}

/// A seed on a passable cell, by its stored cost, then its index.
using WaitingSeed = std::pair<std::uint32_t, std::uint32_t>;

}  // namespace luminav
