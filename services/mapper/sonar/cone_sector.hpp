#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// Rows of a filled convex region: for each row the first and last column, both included; empty where last < first.
struct CellSpans {
  int first_row = 0;
  std::vector<int> first;
  std::vector<int> last;
};

/// Cells whose centre lies in the piece of a circle round `apex` between two angles [rad, world], less than half a turn
/// apart; clipped to the grid. Pieces that touch share no cell but those exactly on the line between them. The spans
/// are overwritten.
void fill_sector(const GridGeometry& geometry, const Eigen::Vector2d& apex, double from_angle, double to_angle,
                 double radius, CellSpans& spans);

/// What is taken from the evidence of a cell.
struct EvidenceVote {
  std::int8_t change = 0;  ///< not above 0
  std::int8_t min = 0;     ///< what lies below already stays

  /// No branch: half of the cells have come to the least.
  [[nodiscard]] std::int8_t of(std::int8_t cell) const {
    return static_cast<std::int8_t>(std::max<int>(cell + change, std::min<int>(cell, min)));
  }
};

/// Takes a vote from the cells of a sector, those of `fill_sector`. The spans are for what it needs in between.
void lower_sector(const GridGeometry& geometry, const Eigen::Vector2d& apex, double from_angle, double to_angle,
                  double radius, const EvidenceVote& vote, CellSpans& spans, std::vector<std::int8_t>& evidence);

}  // namespace luminav
