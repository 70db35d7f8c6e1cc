#pragma once

#include <cstdint>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// What makes a cell solid, and what makes one unknown.
struct CellReading {
  bool disputed_is_wall = true;
  bool unknown_blocks = true;   ///< false: no cell is unknown
  std::int8_t occupied = 127;   ///< evidence above makes a cell solid
  std::int8_t not_free = -128;  ///< evidence above leaves a cell unknown of which the building's map knows nothing
};

/// Reads `columns` cells of a row into bits, the lowest column in the lowest bit: (columns + 63) / 64 words each, of
/// which all are written.
void read_cells(const CellReading& reading, const Prior* prior, const std::int8_t* evidence, int columns,
                std::uint64_t* solid, std::uint64_t* unknown);

}  // namespace luminav
