#include "services/common/process/lcm_conversions.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace luminav {
namespace {

constexpr std::size_t kTileCells = static_cast<std::size_t>(kTileSide) * kTileSide;
constexpr int kFastCompression = 1;  // a tile shrinks to 100-400 bytes at any level
constexpr double kFarthest = 1e5;    // [m]
constexpr double kMaxTurns = 1e3;    // [rad] of a heading; it ought to be wrapped
constexpr double kFastest = 10.0;    // [m/s]
constexpr double kQuickest = 100.0;  // [rad/s]

/// Odometry and poses alike; a comparison with what is no number is false.
template <typename Message>
bool is_possible_motion(const Message& message) {
  return std::abs(message.x) <= kFarthest && std::abs(message.y) <= kFarthest && std::abs(message.theta) <= kMaxTurns &&
         std::abs(message.linear) <= kFastest && std::abs(message.angular) <= kQuickest;
}

}  // namespace

bool is_possible(const odometry_t& message) {
  return is_possible_motion(message);
}

bool is_possible(const pose_t& message) {
  return is_possible_motion(message);
}

grid_tile_t encode_tile(const OccupancyGrid& grid, int tile_column, int tile_row) {
  std::array<std::uint8_t, 2 * kTileCells> layers{};
  const GridGeometry& geometry = grid.geometry;
  const int first_column = tile_column * kTileSide;
  const int columns = std::min(kTileSide, geometry.columns - first_column);
  for (int row = 0; row < std::min(kTileSide, geometry.rows - tile_row * kTileSide); ++row) {
    const std::size_t source = geometry.index({first_column, tile_row * kTileSide + row});
    const std::size_t target = static_cast<std::size_t>(row) * kTileSide;
    for (std::size_t i = 0; i < static_cast<std::size_t>(columns); ++i) {
      layers[target + i] = static_cast<std::uint8_t>(grid.prior[source + i]);
      layers[kTileCells + target + i] = static_cast<std::uint8_t>(grid.evidence[source + i]);
    }
  }
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

bool apply_tile(const grid_tile_t& tile, OccupancyGrid& grid) {
  if (!is_possible(tile) || !(geometry_of(tile) == grid.geometry)) {
    return false;
  }
  std::array<std::uint8_t, 2 * kTileCells> layers{};
  uLongf size = layers.size();
  if (uncompress(layers.data(), &size, tile.data.data(), static_cast<uLong>(tile.size)) != Z_OK ||
      size != layers.size()) {
    return false;
  }
  const auto is_prior = [](std::uint8_t value) { return value <= static_cast<std::uint8_t>(Prior::kDisputed); };
  if (!std::all_of(layers.begin(), layers.begin() + kTileCells, is_prior)) {
    return false;
  }
  const int first_column = tile.tile_column * kTileSide;
  const auto columns = static_cast<std::size_t>(std::min(kTileSide, grid.geometry.columns - first_column));
  for (int row = 0; row < std::min(kTileSide, grid.geometry.rows - tile.tile_row * kTileSide); ++row) {
    const std::size_t target = grid.geometry.index({first_column, tile.tile_row * kTileSide + row});
    const std::size_t source = static_cast<std::size_t>(row) * kTileSide;
    for (std::size_t i = 0; i < columns; ++i) {
      grid.prior[target + i] = static_cast<Prior>(layers[source + i]);
      grid.evidence[target + i] = static_cast<std::int8_t>(layers[kTileCells + source + i]);
    }
  }
  return true;
}

}  // namespace luminav
