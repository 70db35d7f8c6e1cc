#include "services/planner/wavefront.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

namespace luminav {
namespace {

constexpr std::uint32_t kStraight = 5;  // 5 and 7 stand for 1 and sqrt 2 within 1 %
constexpr std::uint32_t kDiagonal = 7;
constexpr std::size_t kBuckets = 256;  // more than the dearest step, 7 * 36

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

}  // namespace

void grow_wave(const std::vector<std::uint8_t>& prices, int columns, const std::vector<WaveSeed>& seeds,
               std::int64_t stop_at, WaveField& field) {
  field.columns = columns;
  field.cost.assign(prices.size(), WaveField::kUnreached);
  // seeds may cost more than one turn of the ring: they enter when the wave comes by
  std::vector<std::pair<std::uint32_t, std::uint32_t>> waiting;
  for (const WaveSeed& seed : seeds) {
    const auto cell = static_cast<std::uint32_t>(seed.cell.row) * static_cast<std::uint32_t>(columns) +
                      static_cast<std::uint32_t>(seed.cell.column);
    if (prices[cell] != 0) {
      waiting.emplace_back(seed.cost, cell);
    }
  }
  std::sort(waiting.begin(), waiting.end());
  std::array<std::vector<std::uint32_t>, kBuckets> buckets;
  const std::array<Step, 8> steps = steps_of(columns);
  std::size_t next_seed = 0;
  std::size_t queued = 0;
  std::uint32_t level = waiting.empty() ? 0 : waiting.front().first;
  while (queued > 0 || next_seed < waiting.size()) {
    if (queued == 0) {
      level = std::max(level, waiting[next_seed].first);
    }
    for (; next_seed < waiting.size() && waiting[next_seed].first <= level; ++next_seed) {
      const auto [cost, cell] = waiting[next_seed];
      if (cost < field.cost[cell]) {
        field.cost[cell] = cost;
        buckets[cost % kBuckets].push_back(cell);
        ++queued;
      }
    }
    std::vector<std::uint32_t>& bucket = buckets[level % kBuckets];
    // a cell's own step costs at least 5, so the bucket does not grow while it is read
    for (const std::uint32_t cell : bucket) {
      if (field.cost[cell] != level) {
        continue;  // a cheaper way was found after it was queued
      }
      if (static_cast<std::int64_t>(cell) == stop_at) {
        return;
      }
      // going towards the seed, the robot enters `cell` from its neighbours
      const std::uint32_t price = prices[cell];
      for (const Step& step : steps) {
        const std::size_t neighbour = moved(cell, step.offset);
        const std::uint32_t cost = level + price * step.length;
        if (prices[neighbour] != 0 && cost < field.cost[neighbour]) {
          field.cost[neighbour] = cost;
          buckets[cost % kBuckets].push_back(static_cast<std::uint32_t>(neighbour));
          ++queued;
        }
      }
    }
    queued -= bucket.size();
    bucket.clear();
    ++level;
  }
}

std::vector<std::size_t> descend(const std::vector<std::uint8_t>& prices, const WaveField& field, std::size_t start) {
  std::vector<std::size_t> cells;
  if (start >= field.cost.size() || field.cost[start] == WaveField::kUnreached) {
    return cells;
  }
  const std::array<Step, 8> steps = steps_of(field.columns);
  std::size_t cell = start;
  std::ptrdiff_t last_offset = 0;
  cells.push_back(cell);
  while (true) {
    std::size_t best = cell;
    std::uint32_t best_cost = WaveField::kUnreached;
    for (const Step& step : steps) {
      const std::size_t neighbour = moved(cell, step.offset);
      if (field.cost[neighbour] >= field.cost[cell]) {
        continue;
      }
      const std::uint32_t cost = field.cost[neighbour] + prices[neighbour] * step.length;
      // straight on where it costs the same
      if (cost < best_cost || (cost == best_cost && step.offset == last_offset)) {
        best = neighbour;
        best_cost = cost;
      }
    }
    // a seed is where no neighbour explains the cost
    if (best == cell || best_cost > field.cost[cell]) {
      return cells;
    }
    last_offset = static_cast<std::ptrdiff_t>(best) - static_cast<std::ptrdiff_t>(cell);
    cell = best;
    cells.push_back(cell);
  }
}

std::vector<std::uint32_t> wavefront_labels(const std::vector<std::uint8_t>& prices, int columns, std::size_t start,
                                            std::size_t goal) {
  std::vector<std::uint32_t> labels(prices.size(), 0);
  for (std::size_t i = 0; i < prices.size(); ++i) {
    labels[i] = prices[i] == 0 ? 1 : 0;
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
