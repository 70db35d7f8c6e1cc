#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/planner/space/bit_grid.hpp"
#include "services/planner/space/cost_terrain.hpp"

namespace luminav {

/// A cell from which a cost field grows, and what it costs to end there.
struct CostSeed {
  Cell cell;
  std::uint32_t cost = 0;
};

/// Costs from every reachable cell to the nearest seed.
struct CostField {
  static constexpr std::uint32_t kUnreached = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t kBlocked = 0;
  int columns = 0;
  std::vector<std::uint32_t> stored;      // row-major: cost + 1, kBlocked, or kUnreached
  std::uint32_t settled_to = kUnreached;  // stored values above are not final: growing was stopped there
  std::vector<std::uint64_t> pending;     // what would have come next: a heap, for repair_cost_field
  std::size_t pending_needed = 0;         // of these, when they were counted last

  [[nodiscard]] bool is_reached(std::size_t cell) const {
    return stored[cell] != kBlocked && stored[cell] != kUnreached && stored[cell] <= settled_to;
  }
  /// kUnreached where no path leads, or growing stopped before.
  [[nodiscard]] std::uint32_t cost(std::size_t cell) const { return is_reached(cell) ? stored[cell] - 1 : kUnreached; }
};

/// Where growing may end: `margin` beyond the cost of a cell.
struct CostStop {
  std::int64_t cell = -1;    // index; -1 = nowhere
  std::uint32_t margin = 0;  // in costs; what may be needed when the path gets longer
};

/// Grows the field from the seeds over all passable cells: a straight step costs 5 times the price of the cell entered
/// towards the seed, a diagonal one 7 times. Exact: Dijkstra 1959 with a ring of buckets (Dial 1969). Seeds on
/// blocked cells are left out.
void grow_cost_field(const CostTerrain& terrain, const std::vector<CostSeed>& seeds, const CostStop& stop,
                     CostField& field);

/// Makes a field of one seed right again after cells changed, as far as the path from `stop.cell` needs it: the same
/// field as a new one up to `settled_to`. What lies beyond stays pending until a path needs it. The work grows with the
/// cells whose cost changes (Koenig and Likhachev 2002, LPA*, with the raised cells first). False where that is too
/// many: then the field is good for nothing, and a new one is no slower. Not for a terrain that forbids steps.
[[nodiscard]] bool repair_cost_field(const CostTerrain& terrain, const std::vector<PriceChange>& changes,
                                     const CostStop& stop, CostField& field);

/// Cells from start to a seed down the field, both included. Empty when the start was not reached.
std::vector<std::size_t> follow_gradient(const CostTerrain& terrain, const CostField& field, std::size_t start);

/// The paper's Wavefront: the goal is 2, its neighbours 3, and so on over the eight neighbours, until the start is
/// reached; occupied cells are 1, cells not reached 0.
std::vector<std::uint32_t> wavefront_labels(const BitGrid& passable, std::size_t start, std::size_t goal);

/// Cells from start to goal down the labels, both included; of equal neighbours the one that goes straight on. Empty
/// when the start has no label.
std::vector<std::size_t> follow_labels(const std::vector<std::uint32_t>& labels, int columns, std::size_t start);

}  // namespace luminav
