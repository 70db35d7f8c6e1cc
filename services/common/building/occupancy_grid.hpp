#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "services/common/geometry/rounding.hpp"

namespace luminav {

/// Cell of a grid, counted from the lower left corner.
struct Cell {
  int column = 0;
  int row = 0;
  friend bool operator==(const Cell&, const Cell&) = default;
};

/// Size and place of a grid; the only code that turns metres into cells and back.
struct GridGeometry {
  double resolution = 0.1;                           // [m] side of a cell
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  // [m] world, lower left corner of cell (0, 0)
  int columns = 0;
  int rows = 0;

  [[nodiscard]] Cell cell_at(const Eigen::Vector2d& point_in_world) const {
    return {floor_to_int((point_in_world.x() - origin.x()) / resolution),
            floor_to_int((point_in_world.y() - origin.y()) / resolution)};
  }
  [[nodiscard]] Eigen::Vector2d centre_of(const Cell& cell) const {
    return {origin.x() + (cell.column + 0.5) * resolution, origin.y() + (cell.row + 0.5) * resolution};
  }
  [[nodiscard]] bool contains(const Cell& cell) const {
    return cell.column >= 0 && cell.row >= 0 && cell.column < columns && cell.row < rows;
  }
  [[nodiscard]] std::size_t index(const Cell& cell) const {
    return static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(cell.column);
  }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  friend bool operator==(const GridGeometry&, const GridGeometry&) = default;
};

/// What the building's map says of a cell. The numbers are those of GRID_TILE.
enum class Prior : std::uint8_t { kUnknown = 0, kFree = 1, kOccupied = 2, kDisputed = 3 };

/// A map as an architect or an earlier drive left it; row-major from the lower left.
struct PriorMap {
  GridGeometry geometry;
  std::vector<Prior> cells;

  /// Outside the map everything is unknown.
  [[nodiscard]] Prior at(const Eigen::Vector2d& point_in_world) const {
    const Cell cell = geometry.cell_at(point_in_world);
    return geometry.contains(cell) ? cells[geometry.index(cell)] : Prior::kUnknown;
  }
};

/// Brings a map to another resolution [m]: a cell is occupied if anything in it is, free if it is all free, else
/// unknown. Walls never get lost.
PriorMap resample(const PriorMap& map, double resolution);

/// Evidence is stored as log-odds times this, clamped to int8 (1 = 0.05).
inline constexpr double kEvidencePerLogOdds = 20.0;

/// Side of a tile in cells, as in GRID_TILE.
inline constexpr int kTileSide = 64;

/// The live grid: what the building's map says (prior) beside what the sonars say (evidence). Row-major from the lower
/// left, both layers.
struct OccupancyGrid {
  GridGeometry geometry;
  std::vector<Prior> prior;
  std::vector<std::int8_t> evidence;

  OccupancyGrid() = default;
  /// All unknown, no evidence.
  explicit OccupancyGrid(const GridGeometry& size);

  [[nodiscard]] int tile_columns() const { return (geometry.columns + kTileSide - 1) / kTileSide; }
  [[nodiscard]] int tile_rows() const { return (geometry.rows + kTileSide - 1) / kTileSide; }
};

}  // namespace luminav
