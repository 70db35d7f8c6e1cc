#include "drivers/simulator/world/free_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/configuration/toml_table.hpp"

namespace luminav {

std::vector<int> label_regions(const GridGeometry& geometry, const std::vector<bool>& passes) {
  std::vector<int> labels(passes.size(), -1);
  std::vector<Cell> open;
  int next = 0;
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      const std::size_t seed = geometry.index({column, row});
      if (!passes[seed] || labels[seed] >= 0) {
        continue;
      }
      labels[seed] = next;
      open.push_back({column, row});
      while (!open.empty()) {
        const Cell cell = open.back();
        open.pop_back();
        const std::array<Cell, 4> neighbours{{{cell.column + 1, cell.row},
                                              {cell.column - 1, cell.row},
                                              {cell.column, cell.row + 1},
                                              {cell.column, cell.row - 1}}};
        for (const Cell& neighbour : neighbours) {
          if (geometry.contains(neighbour) && passes[geometry.index(neighbour)] &&
              labels[geometry.index(neighbour)] < 0) {
            labels[geometry.index(neighbour)] = next;
            open.push_back(neighbour);
          }
        }
      }
      ++next;
    }
  }
  return labels;
}

FreeSpace::FreeSpace(const PriorMap& map) {
  if (map.cells.empty()) {
    throw ConfigurationError("the building has no map, and nothing can be placed at random without one");
  }
  distances_ = distance_to_not_free(map);
  const GridGeometry& geometry = distances_.geometry();
  std::vector<bool> passes(geometry.size());
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      passes[geometry.index({column, row})] = distances_.at(Cell{column, row}) >= kPassage;
    }
  }
  const std::vector<int> labels = label_regions(geometry, passes);
  std::vector<std::size_t> sizes(static_cast<std::size_t>(1 + *std::max_element(labels.begin(), labels.end())));
  for (const int label : labels) {
    if (label >= 0) {
      ++sizes[static_cast<std::size_t>(label)];
    }
  }
  const int largest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  in_region_.resize(labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) {
    in_region_[i] = labels[i] == largest;
    if (in_region_[i]) {
      region_.push_back(static_cast<std::uint32_t>(i));
    }
  }
}

Eigen::Vector2d FreeSpace::draw_point(double clearance, SplitMix& generator) const {
  const GridGeometry& geometry = distances_.geometry();
  const auto cell_of = [&geometry](std::uint32_t index) {
    return Cell{static_cast<int>(index) % geometry.columns, static_cast<int>(index) / geometry.columns};
  };
  std::vector<std::uint32_t> candidates;
  if (clearance <= kPassage && !region_.empty()) {
    const double choice = generator.uniform() * static_cast<double>(region_.size());
    return geometry.centre_of(cell_of(region_[static_cast<std::size_t>(choice)]));
  }
  for (const std::uint32_t index : region_) {
    if (distances_.at(cell_of(index)) >= clearance) {
      candidates.push_back(index);
    }
  }
  if (candidates.empty()) {
    throw ConfigurationError(fmt::format("the building's map has no free space with {} m of clearance", clearance));
  }
  const auto choice = static_cast<std::size_t>(generator.uniform() * static_cast<double>(candidates.size()));
  return geometry.centre_of(cell_of(candidates[choice]));
}

bool FreeSpace::contains(const Eigen::Vector2d& point, double clearance) const {
  const GridGeometry& geometry = distances_.geometry();
  const Cell cell = geometry.cell_at(point);
  return geometry.contains(cell) && in_region_[geometry.index(cell)] && distances_.at(cell) >= clearance;
}

bool FreeSpace::is_free_line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius) const {
  const double length = (to - from).norm();
  const int steps = 1 + static_cast<int>(std::ceil(length / (0.5 * distances_.geometry().resolution)));
  for (int i = 0; i <= steps; ++i) {
    if (distances_.at(from + (to - from) * (static_cast<double>(i) / steps)) < radius) {
      return false;
    }
  }
  return true;
}

Eigen::Vector2d draw_free_point(const PriorMap& map, double clearance, SplitMix& generator) {
  return FreeSpace(map).draw_point(clearance, generator);
}

}  // namespace luminav
