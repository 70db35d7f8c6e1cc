#pragma once

#include <array>
#include <cstdint>
#include <luminav/grid_tile_t.hpp>
#include <optional>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// Prior, then evidence of the cells of a tile, row after row; what lies beyond the grid is 0.
using TileLayers = std::array<std::uint8_t, static_cast<std::size_t>(2) * kTileSide * kTileSide>;

TileLayers tile_layers(const OccupancyGrid& grid, int tile_column, int tile_row);

/// One tile of a grid with geometry and data filled in; stamps, sessions and revision are the sender's.
grid_tile_t encode_tile(const OccupancyGrid& grid, int tile_column, int tile_row);
grid_tile_t encode_tile(const GridGeometry& geometry, int tile_column, int tile_row, const TileLayers& layers);

/// The cells of a tile; nothing when it is impossible or does not decompress to what it should.
[[nodiscard]] std::optional<TileLayers> decode_tile(const grid_tile_t& tile);

/// Writes the cells of a tile into a grid that has it.
void write_tile(const TileLayers& layers, int tile_column, int tile_row, OccupancyGrid& grid);

/// Writes a tile into a grid of the same geometry. False, and nothing written, when it does not fit or does not
/// decompress to what it should.
[[nodiscard]] bool apply_tile(const grid_tile_t& tile, OccupancyGrid& grid);

/// False for a tile of more than 4096 x 4096 cells, without a finite origin, with a resolution outside 0.01..1 m, or
/// beside its grid.
[[nodiscard]] bool is_possible(const grid_tile_t& tile);
/// Geometry of the whole grid that a tile belongs to.
GridGeometry geometry_of(const grid_tile_t& tile);

}  // namespace luminav
