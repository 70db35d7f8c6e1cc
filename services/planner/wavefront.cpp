#include "services/planner/wavefront.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <functional>
#include <memory>
#include <queue>
#include <tuple>
#include <utility>

namespace luminav {
namespace {

constexpr std::uint32_t kStraight = 5;  // 5 and 7 stand for 1 and sqrt 2 within 1 %
constexpr std::uint32_t kDiagonal = 7;
constexpr std::uint32_t kBuckets = 256;  // more than the dearest step, 7 * 36
constexpr std::uint32_t kUnreached = WaveField::kUnreached;
constexpr std::uint32_t kBlocked = WaveField::kBlocked;

struct Step {
  std::ptrdiff_t offset;
  std::uint32_t length;
};

std::array<Step, 8> steps_of(int columns) {
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

std::size_t moved(std::size_t cell, std::ptrdiff_t offset) {
  return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(cell) + offset);
}

/// Cells of one cost. Room is made before, so that the wave writes without asking.
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

using Ring = std::array<Bucket, kBuckets>;

/// Offers a cost to the neighbours at two offsets and their opposites, and notes who takes it; returns the end of the
/// notes. No branch depends on who takes it: half of them do, which no processor can guess; hence the arithmetic, which
/// compilers don't turn back into branches.
std::uint32_t* offer(std::uint32_t* stored, std::uint32_t cell, std::ptrdiff_t one, std::ptrdiff_t other,
                     std::uint32_t cost, std::uint32_t* notes) {
  for (const std::ptrdiff_t offset : {one, -one, other, -other}) {
    const std::size_t neighbour = moved(cell, offset);
    const std::uint32_t before = stored[neighbour];
    const std::uint32_t takes = cost < before ? 1 : 0;  // never where blocked: that is 0
    *notes = static_cast<std::uint32_t>(neighbour);
    notes += takes;
    stored[neighbour] = before - ((before - cost) & (0U - takes));
  }
  return notes;
}

/// Spreads from all cells of one level; returns how many cells were queued. A cell whose cost is another now was found
/// on a cheaper way after it was queued.
std::size_t spread_level(const WaveTerrain& terrain, std::uint32_t level, Ring& ring, std::uint32_t* stored) {
  const Bucket& bucket = ring[level % kBuckets];
  const std::uint32_t* cells = bucket.cells();
  const std::size_t count = bucket.size();
  const std::ptrdiff_t row = terrain.columns();
  if (terrain.classes == nullptr) {
    const std::uint32_t along = level + terrain.class_price[0] * kStraight;
    const std::uint32_t across = level + terrain.class_price[0] * kDiagonal;
    Bucket& next_along = ring[along % kBuckets];
    Bucket& next_across = ring[across % kBuckets];
    std::uint32_t* notes_along = next_along.room_for(4 * count);
    std::uint32_t* notes_across = next_across.room_for(4 * count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t cell = cells[i];
      if (stored[cell] == level) {
        notes_along = offer(stored, cell, 1, row, along, notes_along);
        notes_across = offer(stored, cell, row + 1, row - 1, across, notes_across);
      }
    }
    return next_along.take_to(notes_along) + next_across.take_to(notes_across);
  }
  std::size_t queued = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t cell = cells[i];
    if (stored[cell] != level) {
      continue;
    }
    // going towards the seed, the robot enters `cell` from its neighbours
    const std::uint32_t price = terrain.class_price[terrain.classes[cell]];
    const std::uint32_t along = level + price * kStraight;
    const std::uint32_t across = level + price * kDiagonal;
    Bucket& next_along = ring[along % kBuckets];
    Bucket& next_across = ring[across % kBuckets];
    queued += next_along.take_to(offer(stored, cell, 1, row, along, next_along.room_for(4)));
    queued += next_across.take_to(offer(stored, cell, row + 1, row - 1, across, next_across.room_for(4)));
  }
  return queued;
}

// every passable cell unreached, every other blocked
void clear(const BitGrid& passable, std::vector<std::uint32_t>& stored) {
  const auto columns = static_cast<std::size_t>(passable.columns());
  stored.resize(columns * static_cast<std::size_t>(passable.rows()));
  std::uint32_t* cell = stored.data();
  for (int row = 0; row < passable.rows(); ++row) {
    const std::uint64_t* words = passable.row(row);
    for (std::size_t first = 0; first < columns; first += 64) {
      const std::uint64_t word = words[first / 64];
      const std::size_t count = std::min<std::size_t>(64, columns - first);
      if (word == 0 || (count == 64 && word == ~std::uint64_t{0})) {
        std::fill(cell, cell + count, word == 0 ? kBlocked : kUnreached);
      } else {
        for (std::size_t i = 0; i < count; ++i) {
          cell[i] = 0U - static_cast<std::uint32_t>(word >> i & 1U);
        }
      }
      cell += count;
    }
  }
  static_assert(kUnreached == 0U - 1U && kBlocked == 0U);
}

}  // namespace

void grow_wave(const WaveTerrain& terrain, const std::vector<WaveSeed>& seeds, const WaveStop& stop, WaveField& field) {
  field.columns = terrain.columns();
  field.settled_to = kUnreached;
  clear(*terrain.passable, field.stored);
  std::uint32_t* stored = field.stored.data();
  // seeds may cost more than one turn of the ring: they enter when the wave comes by
  std::vector<std::pair<std::uint32_t, std::uint32_t>> waiting;
  for (const WaveSeed& seed : seeds) {
    const auto cell = static_cast<std::uint32_t>(seed.cell.row) * static_cast<std::uint32_t>(field.columns) +
                      static_cast<std::uint32_t>(seed.cell.column);
    if (stored[cell] != kBlocked) {
      waiting.emplace_back(seed.cost + 1, cell);
    }
  }
  std::sort(waiting.begin(), waiting.end());
  const auto ring = std::make_unique<Ring>();
  std::size_t next_seed = 0;
  std::size_t queued = 0;
  std::uint32_t level = waiting.empty() ? 0 : waiting.front().first;
  while ((queued > 0 || next_seed < waiting.size()) && level <= field.settled_to) {
    if (queued == 0) {
      level = std::max(level, waiting[next_seed].first);
    }
    Bucket& bucket = (*ring)[level % kBuckets];
    for (; next_seed < waiting.size() && waiting[next_seed].first <= level; ++next_seed) {
      const auto [cost, cell] = waiting[next_seed];
      if (cost < stored[cell]) {
        stored[cell] = cost;
        *bucket.room_for(1) = cell;
        queued += bucket.take_to(bucket.cells() + bucket.size() + 1);
      }
    }
    // a cell's own step costs at least 5, so the bucket does not grow while it is read
    queued += spread_level(terrain, level, *ring, stored);
    if (stop.cell >= 0 && stored[stop.cell] == level) {
      field.settled_to = level + stop.margin;
    }
    queued -= bucket.size();
    bucket.clear();
    ++level;
  }
  if (queued == 0 && next_seed == waiting.size()) {
    field.settled_to = kUnreached;  // it came everywhere
  }
}

namespace {

/// The work of repair_wave: one queue by cost; of one cost, cells that may have lost their support come first.
class Repair {
 public:
  Repair(const WaveTerrain& terrain, WaveField& field)
      : terrain_(terrain), field_(field), steps_(steps_of(terrain.columns())) {}

  void note(const std::vector<PriceChange>& changes) {
    for (const PriceChange& change : changes) {
      std::uint32_t& own = field_.stored[change.cell];
      if (own == kBlocked) {
        continue;
      }
      doubt_children(change.cell, own, change.price_before);
      if (!is_passable(change.cell)) {
        own = kBlocked;
      }
    }
    for (const PriceChange& change : changes) {
      std::uint32_t& own = field_.stored[change.cell];
      if (!is_passable(change.cell)) {
        continue;
      }
      if (own == kBlocked) {
        own = kUnreached;
        find_support(change.cell);
      } else if (own != kUnreached) {
        queue_.emplace(own, kSpread, change.cell);
      }
    }
  }

  [[nodiscard]] bool run(const WaveStop& stop) {
    const auto goal = static_cast<std::size_t>(stop.cell);
    std::uint32_t limit = field_.settled_to;
    while (!queue_.empty()) {
      const auto [level, task, cell] = queue_.top();
      const std::uint32_t wanted = field_.stored[goal];
      if (wanted != kUnreached && wanted < level) {
        limit = std::min(field_.settled_to, wanted + stop.margin);  // nothing queued can make it cheaper
      }
      if (level > limit) {
        break;
      }
      queue_.pop();
      if (task == kSettle) {
        settle(cell, level);
      } else if (field_.stored[cell] == level) {
        task == kDoubt ? check(cell, level) : spread(cell, level);
      }
    }
    if (!queue_.empty()) {
      field_.settled_to = limit;
    }
    const std::uint32_t reached = field_.stored[goal];
    return field_.settled_to == kUnreached || (reached != kUnreached && reached <= field_.settled_to);
  }

 private:
  enum Task : int { kDoubt = 0, kSettle = 1, kSpread = 2 };

  [[nodiscard]] bool is_passable(std::size_t cell) const {
    const auto columns = static_cast<std::size_t>(field_.columns);
    return terrain_.passable->test({static_cast<int>(cell % columns), static_cast<int>(cell / columns)});
  }
  /// Cells whose way led into this one when it cost `price`.
  void doubt_children(std::size_t cell, std::uint32_t cost, std::uint32_t price) {
    if (cost == kUnreached) {
      return;
    }
    for (const Step& step : steps_) {
      const std::size_t neighbour = moved(cell, step.offset);
      if (field_.stored[neighbour] == cost + price * step.length) {
        queue_.emplace(field_.stored[neighbour], kDoubt, neighbour);
      }
    }
  }
  [[nodiscard]] std::uint32_t best_offer(std::size_t cell) const {
    std::uint32_t best = kUnreached;
    for (const Step& step : steps_) {
      const std::size_t neighbour = moved(cell, step.offset);
      const std::uint32_t cost = field_.stored[neighbour];
      if (cost != kBlocked && cost != kUnreached) {
        best = std::min(best, cost + terrain_.price(neighbour) * step.length);
      }
    }
    return best;
  }
  /// Queues a cell that nothing holds any more. It stays unreached until then: two cells without a way to the seed
  /// would else hold each other up, ever higher.
  void find_support(std::size_t cell) {
    const std::uint32_t cost = best_offer(cell);
    if (cost != kUnreached) {
      queue_.emplace(cost, kSettle, cell);
    }
  }
  void settle(std::size_t cell, std::uint32_t level) {
    if (field_.stored[cell] <= level) {
      return;
    }
    if (best_offer(cell) != level) {
      find_support(cell);  // who made the offer has lost its own way since
      return;
    }
    field_.stored[cell] = level;
    spread(cell, level);
  }
  void check(std::size_t cell, std::uint32_t level) {
    if (best_offer(cell) == level) {
      return;  // another neighbour holds it
    }
    field_.stored[cell] = kUnreached;
    doubt_children(cell, level, terrain_.price(cell));
    find_support(cell);
  }
  void spread(std::size_t cell, std::uint32_t level) {
    const std::uint32_t price = terrain_.price(cell);
    for (const Step& step : steps_) {
      const std::size_t neighbour = moved(cell, step.offset);
      const std::uint32_t cost = level + price * step.length;
      if (cost < field_.stored[neighbour]) {
        field_.stored[neighbour] = cost;
        queue_.emplace(cost, kSpread, neighbour);
      }
    }
  }

  using Entry = std::tuple<std::uint32_t, int, std::size_t>;
  const WaveTerrain& terrain_;
  WaveField& field_;
  std::array<Step, 8> steps_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace

bool repair_wave(const WaveTerrain& terrain, const std::vector<PriceChange>& changes, const WaveStop& stop,
                 WaveField& field) {
  Repair repair(terrain, field);
  repair.note(changes);
  return repair.run(stop);
}

std::vector<std::size_t> descend(const WaveTerrain& terrain, const WaveField& field, std::size_t start) {
  std::vector<std::size_t> cells;
  if (start >= field.stored.size() || !field.is_reached(start)) {
    return cells;
  }
  const std::array<Step, 8> steps = steps_of(field.columns);
  std::size_t cell = start;
  std::ptrdiff_t last_offset = 0;
  cells.push_back(cell);
  while (true) {
    std::size_t best = cell;
    std::uint32_t best_cost = kUnreached;
    for (const Step& step : steps) {
      const std::size_t neighbour = moved(cell, step.offset);
      const std::uint32_t there = field.stored[neighbour];
      if (there == kBlocked || there >= field.stored[cell]) {
        continue;
      }
      const std::uint32_t cost = there + terrain.price(neighbour) * step.length;
      // straight on where it costs the same
      if (cost < best_cost || (cost == best_cost && step.offset == last_offset)) {
        best = neighbour;
        best_cost = cost;
      }
    }
    // a seed is where no neighbour explains the cost
    if (best == cell || best_cost > field.stored[cell]) {
      return cells;
    }
    last_offset = static_cast<std::ptrdiff_t>(best) - static_cast<std::ptrdiff_t>(cell);
    cell = best;
    cells.push_back(cell);
  }
}

std::vector<std::uint32_t> wavefront_labels(const BitGrid& passable, std::size_t start, std::size_t goal) {
  const int columns = passable.columns();
  std::vector<std::uint32_t> labels;
  labels.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(passable.rows()));
  for (int row = 0; row < passable.rows(); ++row) {
    for (int column = 0; column < columns; ++column) {
      labels.push_back(passable.test({column, row}) ? 0 : 1);
    }
  }
  if (labels[goal] == 1) {
    return labels;
  }
  const std::array<Step, 8> steps = steps_of(columns);
  std::vector<std::size_t> front = {goal};
  std::vector<std::size_t> next;
  labels[goal] = 2;
  for (std::uint32_t label = 3; !front.empty() && labels[start] == 0; ++label) {
    next.clear();
    for (const std::size_t cell : front) {
      for (const Step& step : steps) {
        const std::size_t neighbour = moved(cell, step.offset);
        if (labels[neighbour] == 0) {
          labels[neighbour] = label;
          next.push_back(neighbour);
        }
      }
    }
    front.swap(next);
  }
  return labels;
}

std::vector<std::size_t> follow_labels(const std::vector<std::uint32_t>& labels, int columns, std::size_t start) {
  std::vector<std::size_t> cells;
  if (start >= labels.size() || labels[start] < 2) {
    return cells;
  }
  const std::array<Step, 8> steps = steps_of(columns);
  std::size_t cell = start;
  std::ptrdiff_t last_offset = 0;
  cells.push_back(cell);
  while (labels[cell] > 2) {
    const std::uint32_t wanted = labels[cell] - 1;
    std::ptrdiff_t chosen = 0;
    for (const Step& step : steps) {
      const bool fits = labels[moved(cell, step.offset)] == wanted;
      if (fits && (chosen == 0 || step.offset == last_offset)) {
        chosen = step.offset;
      }
    }
    assert(chosen != 0);
    cell = moved(cell, chosen);
    last_offset = chosen;
    cells.push_back(cell);
  }
  return cells;
}

}  // namespace luminav
