#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <memory>
#include <numeric>
#include <vector>

#include "services/planner/search/grid_steps.hpp"

// Of all shortest ways to a cell one is kept: the one that takes its diagonal steps first. A cell that was entered
// straight needs to spread straight on only, one that was entered diagonally to three neighbours, and to those round a
// corner where something blocks the way round (Harabor and Grastien 2011; Sturtevant and Rabin 2016). So most cells are
// offered a cost once instead of eight times.

namespace luminav {
namespace {

constexpr std::uint32_t kUnreached = CostField::kUnreached;
constexpr std::uint32_t kBlocked = CostField::kBlocked;

// of a step, as in grid_steps
enum Direction : std::size_t { kEast, kWest, kNorth, kSouth, kNorthEast, kNorthWest, kSouthEast, kSouthWest };
constexpr std::size_t kDirections = 8;

class EvenCostField {
 public:
  EvenCostField(int columns, std::uint32_t price, std::uint32_t unit, CostField& field)
      : row_(columns),
        straight_(kStraight * price),
        diagonal_(kDiagonal * price),
        unit_(unit),
        stored_(field.stored.data()),
        entered_(std::make_unique_for_overwrite<std::uint8_t[]>(field.stored.size())),
        slots_(std::bit_ceil(diagonal_ / unit + 1)),
        ring_(slots_ * kDirections) {}

  void add_seed(std::uint32_t cell, std::uint32_t level) {
    if (level >= stored_[cell]) {
      return;
    }
    stored_[cell] = level;
    entered_[cell] = 0xFF;
    // together the diagonal ones spread to all sides
    for (const Direction direction : {kNorthEast, kNorthWest, kSouthEast, kSouthWest}) {
      bucket(direction, level).add(cell);
      ++queued_;
    }
  }

  void keep_queued(CostField& field) const {
    for (const Bucket& bucket : ring_) {
      keep_pending(bucket, field);
    }
  }

  [[nodiscard]] std::size_t queued() const { return queued_; }

  void spread(std::uint32_t level) {
    straight(kEast, 1, level, row_, kNorthEast, kSouthEast);
    straight(kWest, -1, level, row_, kNorthWest, kSouthWest);
    straight(kNorth, row_, level, 1, kNorthEast, kNorthWest);
    straight(kSouth, -row_, level, 1, kSouthEast, kSouthWest);
    diagonal(kNorthEast, level, 1, kEast, row_, kNorth, kNorthWest, kSouthEast);
    diagonal(kNorthWest, level, -1, kWest, row_, kNorth, kNorthEast, kSouthWest);
    diagonal(kSouthEast, level, 1, kEast, -row_, kSouth, kSouthWest, kNorthEast);
    diagonal(kSouthWest, level, -1, kWest, -row_, kSouth, kSouthEast, kNorthWest);
  }

 private:
  /// What was found out about where the cells of one direction go that are entered next.
  struct Notes {
    Bucket* bucket;
    std::uint32_t* end;
    std::uint32_t cost;
    std::uint8_t entered;  // bit of the direction
  };
  Bucket& bucket(Direction direction, std::uint32_t level) {
    return ring_[(level / unit_ & (slots_ - 1)) * kDirections + direction];
  }
  Notes notes(Direction direction, std::uint32_t level, std::size_t room) {
    const std::uint32_t cost = level + (direction < kNorthEast ? straight_ : diagonal_);
    Bucket& next = bucket(direction, cost);
    return {&next, next.room_for(room), cost, static_cast<std::uint8_t>(1U << direction)};
  }
  void close(const Notes& notes) { queued_ += notes.bucket->take_to(notes.end); }

  /// A cell that is entered from two sides at one cost spreads for both, once each.
  void offer(std::size_t cell, Notes& notes) {
    const std::uint32_t before = stored_[cell];
    if (notes.cost < before) {
      stored_[cell] = notes.cost;
      entered_[cell] = notes.entered;
      *notes.end++ = static_cast<std::uint32_t>(cell);
    } else if (notes.cost == before && (entered_[cell] & notes.entered) == 0) {
      entered_[cell] |= notes.entered;
      *notes.end++ = static_cast<std::uint32_t>(cell);
    }
  }

  /// Straight on, and round the corners of what blocks on the left or right.
  void straight(Direction direction, std::ptrdiff_t ahead, std::uint32_t level, std::ptrdiff_t side, Direction left,
                Direction right) {
    Bucket& now = bucket(direction, level);
    const std::size_t count = now.size();
    if (count == 0) {
      return;
    }
    Notes on = notes(direction, level, count);
    Notes round_left = notes(left, level, count);
    Notes round_right = notes(right, level, count);
    const std::uint32_t* cells = now.cells();
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t cell = cells[i];
      if (stored_[cell] != level) {
        continue;  // a cheaper way was found after it was queued
      }
      offer(moved(cell, ahead), on);
      if (stored_[moved(cell, side)] == kBlocked) {
        offer(moved(cell, ahead + side), round_left);
      }
      if (stored_[moved(cell, -side)] == kBlocked) {
        offer(moved(cell, ahead - side), round_right);
      }
    }
    close(on);
    close(round_left);
    close(round_right);
    queued_ -= count;
    now.clear();
  }

  /// On, to the two sides of its course, and round what blocks behind it.
  void diagonal(Direction direction, std::uint32_t level, std::ptrdiff_t across, Direction to_across,
                std::ptrdiff_t along, Direction to_along, Direction round_across, Direction round_along) {
    Bucket& now = bucket(direction, level);
    const std::size_t count = now.size();
    if (count == 0) {
      return;
    }
    Notes on = notes(direction, level, count);
    Notes by_across = notes(to_across, level, count);
    Notes by_along = notes(to_along, level, count);
    Notes behind_across = notes(round_across, level, count);
    Notes behind_along = notes(round_along, level, count);
    const std::uint32_t* cells = now.cells();
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t cell = cells[i];
      if (stored_[cell] != level) {
        continue;
      }
      offer(moved(cell, across), by_across);
      offer(moved(cell, along), by_along);
      offer(moved(cell, across + along), on);
      if (stored_[moved(cell, -across)] == kBlocked) {
        offer(moved(cell, along - across), behind_across);
      }
      if (stored_[moved(cell, -along)] == kBlocked) {
        offer(moved(cell, across - along), behind_along);
      }
    }
    close(on);
    close(by_across);
    close(by_along);
    close(behind_across);
    close(behind_along);
    queued_ -= count;
    now.clear();
  }

  std::ptrdiff_t row_;
  std::uint32_t straight_;  // cost of a step
  std::uint32_t diagonal_;
  std::uint32_t unit_;  // all levels differ by multiples of it
  std::uint32_t* stored_;
  std::unique_ptr<std::uint8_t[]> entered_;  // by cell: a bit for each direction of its cost; of reached cells only
  std::size_t slots_;                        // of the ring
  std::vector<Bucket> ring_;                 // by level, then direction
  std::size_t queued_ = 0;
};

}  // namespace

void grow_even_cost_field(const BitGrid& passable, std::uint32_t price, const std::vector<WaitingSeed>& seeds,
                          const CostStop& stop, CostField& field) {
  if (seeds.empty()) {
    return;
  }
  const std::uint32_t first = seeds.front().first;
  std::uint32_t unit = price;
  for (const WaitingSeed& seed : seeds) {
    unit = std::gcd(unit, seed.first - first);
  }
  EvenCostField front(passable.columns(), price, unit, field);
  std::size_t next_seed = 0;
  std::uint32_t level = first;
  while ((front.queued() > 0 || next_seed < seeds.size()) && level <= field.settled_to) {
    if (front.queued() == 0) {
      level = std::max(level, seeds[next_seed].first);
    }
    for (; next_seed < seeds.size() && seeds[next_seed].first <= level; ++next_seed) {
      front.add_seed(seeds[next_seed].second, seeds[next_seed].first);
    }
    if (stop.cell >= 0 && field.stored[static_cast<std::size_t>(stop.cell)] == level) {
      field.settled_to = level + stop.margin;
    }
    front.spread(level);
    level += unit;
  }
  if (front.queued() == 0 && next_seed == seeds.size()) {
    field.settled_to = kUnreached;  // it came everywhere
    return;
  }
  front.keep_queued(field);
  std::make_heap(field.pending.begin(), field.pending.end(), std::greater<>());
}

}  // namespace luminav
