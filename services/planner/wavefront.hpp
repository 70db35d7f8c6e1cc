#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// A cell from which a wave starts, and what it costs to end there.
struct WaveSeed {
  Cell cell;
  std::uint32_t cost = 0;
};

/// Costs from every reachable cell to the nearest seed.
struct WaveField {
  static constexpr std::uint32_t kUnreached = std::numeric_limits<std::uint32_t>::max();
  int columns = 0;
  std::vector<std::uint32_t> cost;  // row-major; kUnreached where no way leads
};

/// Grows a wave from the seeds over all cells with a price above 0: a straight step costs 5 times the price of the cell
/// entered on the way to the seed, a diagonal one 7 times. Exact: Dijkstra 1959 with a ring of 256 buckets (Dial 1969).
/// Needs prices of at most 36 and a blocked outermost ring. Seeds on blocked cells are left out. `stop_at` >= 0 ends
/// the wave once that cell (its index) is settled.
void grow_wave(const std::vector<std::uint8_t>& prices, int columns, const std::vector<WaveSeed>& seeds,
               std::int64_t stop_at, WaveField& field);

/// The paper's Wavefront: the goal is 2, its neighbours 3, and so on over the eight neighbours, until the start is
/// reached; occupied cells are 1, cells not reached 0. Needs a blocked outermost ring.
std::vector<std::uint32_t> wavefront_labels(const std::vector<std::uint8_t>& prices, int columns, std::size_t start,
                                            std::size_t goal);

/// Cells from start to goal down the labels, both included; of equal neighbours the one that goes straight on. Empty
/// when the start has no label.
std::vector<std::size_t> follow_labels(const std::vector<std::uint32_t>& labels, int columns, std::size_t start);

/// Cells from start to a seed down the field, both included. Empty when the start was not reached.
std::vector<std::size_t> descend(const std::vector<std::uint8_t>& prices, const WaveField& field, std::size_t start);

}  // namespace luminav
