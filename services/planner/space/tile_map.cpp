#include "services/planner/space/tile_map.hpp"

#include <utility>

#include "services/common/process/lcm_conversions.hpp"

namespace luminav {

TileMap::Result TileMap::add(const grid_tile_t& tile) {
  if (!is_possible(tile)) {
    return Result::kRefused;
  }
  const GridGeometry geometry = geometry_of(tile);
  if (tile.map_session != session_ || !(geometry == grid_.geometry)) {
    // tiles of a session that has ended may still be on their way
    if (tile.map_session < session_ && session_ - tile.map_session < 60'000'000) {
      return Result::kRefused;
    }
    if (is_complete()) {
      before_ = std::move(grid_);
    }
    grid_ = OccupancyGrid(geometry);
    revisions_.assign(static_cast<std::size_t>(grid_.tile_columns()) * static_cast<std::size_t>(grid_.tile_rows()), -1);
    received_ = 0;
    session_ = tile.map_session;
  }
  std::int32_t& revision =
      revisions_[static_cast<std::size_t>(tile.tile_row) * static_cast<std::size_t>(grid_.tile_columns()) +
                 static_cast<std::size_t>(tile.tile_column)];
  if (tile.revision <= revision) {
    return tile.revision == revision ? Result::kUnchanged : Result::kRefused;
  }
  if (!apply_tile(tile, grid_)) {
    return Result::kRefused;
  }
  received_ += revision < 0 ? 1 : 0;
  revision = tile.revision;
  if (is_complete()) {
    before_.reset();
  }
  return Result::kChanged;
}

void TileMap::missing(std::size_t max, std::vector<std::int32_t>& columns, std::vector<std::int32_t>& rows) const {
  columns.clear();
  rows.clear();
  for (std::size_t i = 0; i < revisions_.size() && columns.size() < max; ++i) {
    if (revisions_[i] < 0) {
      columns.push_back(static_cast<std::int32_t>(i % static_cast<std::size_t>(grid_.tile_columns())));
      rows.push_back(static_cast<std::int32_t>(i / static_cast<std::size_t>(grid_.tile_columns())));
    }
  }
}

}  // namespace luminav
