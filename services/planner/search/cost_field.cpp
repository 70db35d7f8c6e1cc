#include "services/planner/search/cost_field.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <memory>

#include "services/planner/search/grid_steps.hpp"

namespace luminav {
namespace {

constexpr std::uint32_t kBuckets = 256;  // more than the dearest step, 7 * 36
constexpr std::uint32_t kUnreached = CostField::kUnreached;
constexpr std::uint32_t kBlocked = CostField::kBlocked;

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

/// The same as `spread_level`, step by step, where one-way zones forbid some.
std::size_t spread_level_by_lanes(const CostTerrain& terrain, std::uint32_t level, Ring& ring, std::uint32_t* stored) {
  const Bucket& bucket = ring[level % kBuckets];
  const std::array<GridStep, 8> steps = grid_steps(terrain.columns());
  std::size_t queued = 0;
  for (std::size_t k = 0; k < bucket.size(); ++k) {
    const std::uint32_t cell = bucket.cells()[k];
    for (std::size_t i = 0; i < steps.size() && stored[cell] == level; ++i) {
      const std::size_t before = moved(cell, -steps[i].offset);
      const std::uint32_t cost = level + terrain.price(cell) * steps[i].length;
      if (cost < stored[before] && terrain.allows(before, cell, i)) {
        stored[before] = cost;
        Bucket& next = ring[cost % kBuckets];
        std::uint32_t* const end = next.room_for(1);
        *end = static_cast<std::uint32_t>(before);
        queued += next.take_to(end + 1);
      }
    }
  }
  return queued;
}

/// Spreads from all cells of one level; returns how many cells were queued. A cell whose cost is another now was found
/// on a cheaper path after it was queued.
std::size_t spread_level(const CostTerrain& terrain, std::uint32_t level, Ring& ring, std::uint32_t* stored) {
  if (terrain.forbidden != nullptr) {
    return spread_level_by_lanes(terrain, level, ring, stored);
  }
  const Bucket& bucket = ring[level % kBuckets];
  const std::uint32_t* cells = bucket.cells();
  const std::size_t count = bucket.size();
  const std::ptrdiff_t row = terrain.columns();
  std::size_t queued = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t cell = cells[i];
    if (stored[cell] != level) {
      continue;
    }
    // going towards the seed, the robot enters `cell` from its neighbours
    const std::uint32_t price = terrain.price(cell);
    const std::uint32_t along = level + price * kStraight;
    const std::uint32_t across = level + price * kDiagonal;
    Bucket& next_along = ring[along % kBuckets];
    Bucket& next_across = ring[across % kBuckets];
    queued += next_along.take_to(offer(stored, cell, 1, row, along, next_along.room_for(4)));
    queued += next_across.take_to(offer(stored, cell, row + 1, row - 1, across, next_across.room_for(4)));
  }
  return queued;
}

/// Spreads from the seeds, the cheapest first.
void expand_cost_field(const CostTerrain& terrain, const std::vector<WaitingSeed>& waiting, const CostStop& stop,
                       CostField& field) {
  const auto buckets = std::make_unique<Ring>();
  Ring& ring = *buckets;
  std::uint32_t level = waiting.empty() ? 0 : waiting.front().first;
  std::size_t queued = 0;
  std::uint32_t* stored = field.stored.data();
  std::size_t next_seed = 0;
  while ((queued > 0 || next_seed < waiting.size()) && level <= field.settled_to) {
    if (queued == 0) {
      level = std::max(level, waiting[next_seed].first);
    }
    Bucket& bucket = ring[level % kBuckets];
    for (; next_seed < waiting.size() && waiting[next_seed].first <= level; ++next_seed) {
      const auto [cost, cell] = waiting[next_seed];
      if (cost < stored[cell]) {
        stored[cell] = cost;
        *bucket.room_for(1) = cell;
        queued += bucket.take_to(bucket.cells() + bucket.size() + 1);
      }
    }
    // a cell's own step costs at least 5, so the bucket does not grow while it is read
    queued += spread_level(terrain, level, ring, stored);
    if (stop.cell >= 0 && stored[stop.cell] == level) {
      field.settled_to = level + stop.margin;
    }
    queued -= bucket.size();
    bucket.clear();
    ++level;
  }
  if (queued == 0 && next_seed == waiting.size()) {
    field.settled_to = kUnreached;  // it came everywhere
    return;
  }
  for (const Bucket& bucket : ring) {
    keep_pending(bucket, field);
  }
  std::make_heap(field.pending.begin(), field.pending.end(), std::greater<>());
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

void grow_cost_field(const CostTerrain& terrain, const std::vector<CostSeed>& seeds, const CostStop& stop,
                     CostField& field) {
  field.columns = terrain.columns();
  field.settled_to = kUnreached;
  field.pending.clear();
  field.pending_needed = 0;
  clear(*terrain.passable, field.stored);
  std::uint32_t* stored = field.stored.data();
  // seeds may cost more than one turn of the ring: they enter when the front comes by
  std::vector<WaitingSeed> waiting;
  for (const CostSeed& seed : seeds) {
    const auto cell = static_cast<std::uint32_t>(seed.cell.row) * static_cast<std::uint32_t>(field.columns) +
                      static_cast<std::uint32_t>(seed.cell.column);
    if (stored[cell] != kBlocked) {
      waiting.emplace_back(seed.cost + 1, cell);
    }
  }
  std::sort(waiting.begin(), waiting.end());
  expand_cost_field(terrain, waiting, stop, field);
}

}  // namespace luminav
