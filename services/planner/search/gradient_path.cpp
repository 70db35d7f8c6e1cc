#include <array>
#include <cassert>

#include "services/planner/search/cost_field.hpp"
#include "services/planner/search/grid_steps.hpp"

namespace luminav {

std::vector<std::size_t> follow_gradient(const CostTerrain& terrain, const CostField& field, std::size_t start) {
  std::vector<std::size_t> cells;
  if (start >= field.stored.size() || !field.is_reached(start)) {
    return cells;
  }
  const std::array<GridStep, 8> steps = grid_steps(field.columns);
  std::size_t cell = start;
  std::ptrdiff_t last_offset = 0;
  cells.push_back(cell);
  while (true) {
    std::size_t best = cell;
    std::uint32_t best_cost = CostField::kUnreached;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const GridStep& step = steps[i];
      const std::size_t neighbour = moved(cell, step.offset);
      const std::uint32_t there = field.stored[neighbour];
      if (there == CostField::kBlocked || there >= field.stored[cell] || !terrain.allows(cell, neighbour, i)) {
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
  const std::array<GridStep, 8> steps = grid_steps(columns);
  std::vector<std::size_t> front = {goal};
  std::vector<std::size_t> next;
  labels[goal] = 2;
  for (std::uint32_t label = 3; !front.empty() && labels[start] == 0; ++label) {
    next.clear();
    for (const std::size_t cell : front) {
      for (const GridStep& step : steps) {
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
  const std::array<GridStep, 8> steps = grid_steps(columns);
  std::size_t cell = start;
  std::ptrdiff_t last_offset = 0;
  cells.push_back(cell);
  while (labels[cell] > 2) {
    const std::uint32_t wanted = labels[cell] - 1;
    std::ptrdiff_t chosen = 0;
    for (const GridStep& step : steps) {
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
