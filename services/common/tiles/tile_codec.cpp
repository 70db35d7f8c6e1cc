#include "services/common/tiles/tile_codec.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace luminav {
namespace {

constexpr std::size_t kTileCells = static_cast<std::size_t>(kTileSide) * kTileSide;
constexpr int kFastCompression = 1;  // a tile shrinks to 100-400 bytes at any level

}  // namespace

TileLayers tile_layers(const OccupancyGrid& grid, int tile_column, int tile_row) {
  TileLayers layers{};
  const GridGeometry& geometry = grid.geometry;
  const int first_column = tile_column * kTileSide;
  const auto columns = static_cast<std::size_t>(std::min(kTileSide, geometry.columns - first_column));
  for (int row = 0; row < std::min(kTileSide, geometry.rows - tile_row * kTileSide); ++row) {
    const std::size_t source = geometry.index({first_column, tile_row * kTileSide + row});
    const std::size_t target = static_cast<std::size_t>(row) * kTileSide;
    for (std::size_t i = 0; i < columns; ++i) {
      layers[target + i] = static_cast<std::uint8_t>(grid.prior[source + i]);
      layers[kTileCells + target + i] = static_cast<std::uint8_t>(grid.evidence[source + i]);
    }
  }
  return layers;
}

grid_tile_t encode_tile(const GridGeometry& geometry, int tile_column, int tile_row, const TileLayers& layers) {
  grid_tile_t tile{};
  tile.resolution = geometry.resolution;
  tile.origin_x = geometry.origin.x();
  tile.origin_y = geometry.origin.y();
  tile.columns = geometry.columns;
  tile.rows = geometry.rows;
  tile.tile_column = tile_column;
  tile.tile_row = tile_row;
  uLongf size = compressBound(layers.size());
  tile.data.resize(size);
  if (compress2(tile.data.data(), &size, layers.data(), layers.size(), kFastCompression) != Z_OK) {
    throw std::runtime_error("zlib could not compress a tile");
  }
  tile.data.resize(size);
  tile.size = static_cast<std::int32_t>(size);
  return tile;
}

grid_tile_t encode_tile(const OccupancyGrid& grid, int tile_column, int tile_row) {
  return encode_tile(grid.geometry, tile_column, tile_row, tile_layers(grid, tile_column, tile_row));
}

bool is_possible(const grid_tile_t& tile) {
  const bool sizes = tile.columns > 0 && tile.rows > 0 && tile.columns <= 4096 && tile.rows <= 4096;
  const bool numbers =
      std::isfinite(tile.origin_x) && std::isfinite(tile.origin_y) && tile.resolution >= 0.01 && tile.resolution <= 1.0;
  // divided, not multiplied: a column of 2^26 times 64 is 0
  const bool inside = tile.tile_column >= 0 && tile.tile_row >= 0 &&
                      tile.tile_column <= (tile.columns - 1) / kTileSide &&
                      tile.tile_row <= (tile.rows - 1) / kTileSide;
  const bool session = tile.map_session >= 0;  // sessions are subtracted
  return session && sizes && numbers && inside && tile.size >= 0 &&
         static_cast<std::size_t>(tile.size) <= tile.data.size();
}

GridGeometry geometry_of(const grid_tile_t& tile) {
  return {tile.resolution, {tile.origin_x, tile.origin_y}, tile.columns, tile.rows};
}

std::optional<TileLayers> decode_tile(const grid_tile_t& tile) {
  TileLayers layers{};
  uLongf size = layers.size();
  if (!is_possible(tile) || uncompress(layers.data(), &size, tile.data.data(), static_cast<uLong>(tile.size)) != Z_OK ||
      size != layers.size()) {
    return std::nullopt;
  }
  const auto is_prior = [](std::uint8_t value) { return value <= static_cast<std::uint8_t>(Prior::kDisputed); };
  return std::all_of(layers.begin(), layers.begin() + kTileCells, is_prior) ? std::optional(layers) : std::nullopt;
}

void write_tile(const TileLayers& layers, int tile_column, int tile_row, OccupancyGrid& grid) {
  const int first_column = tile_column * kTileSide;
  const auto columns = static_cast<std::size_t>(std::min(kTileSide, grid.geometry.columns - first_column));
  for (int row = 0; row < std::min(kTileSide, grid.geometry.rows - tile_row * kTileSide); ++row) {
    const std::size_t target = grid.geometry.index({first_column, tile_row * kTileSide + row});
    const std::size_t source = static_cast<std::size_t>(row) * kTileSide;
    for (std::size_t i = 0; i < columns; ++i) {
      grid.prior[target + i] = static_cast<Prior>(layers[source + i]);
      grid.evidence[target + i] = static_cast<std::int8_t>(layers[kTileCells + source + i]);
    }
  }
}

bool apply_tile(const grid_tile_t& tile, OccupancyGrid& grid) {
  const std::optional<TileLayers> layers =
      geometry_of(tile) == grid.geometry ? decode_tile(tile) : std::optional<TileLayers>();
  if (layers) {
    write_tile(*layers, tile.tile_column, tile.tile_row, grid);
  }
  return layers.has_value();
}

}  // namespace luminav
