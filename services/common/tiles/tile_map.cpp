#include "services/common/tiles/tile_map.hpp"

#include <utility>

#include "services/common/tiles/tile_codec.hpp"

namespace luminav {

TileMap::Result TileMap::add(const grid_tile_t& tile) {
  if (!is_possible(tile) || tile.revision < 0) {
    return Result::kRefused;
  }
  const GridGeometry geometry = geometry_of(tile);
  const bool is_of_another_map = tile.map_session != session_ || !(geometry == grid_.geometry);
  // tiles of a session that has ended may still be on their way
  if (is_of_another_map && tile.map_session < session_ && session_ - tile.map_session < 60'000'000) {
    return Result::kRefused;
  }
  const auto columns = static_cast<std::size_t>((geometry.columns + kTileSide - 1) / kTileSide);
  const std::size_t index =
      static_cast<std::size_t>(tile.tile_row) * columns + static_cast<std::size_t>(tile.tile_column);
  if (!is_of_another_map && tile.revision <= revisions_[index]) {
    return tile.revision == revisions_[index] ? Result::kUnchanged : Result::kRefused;
  }
  const std::optional<TileLayers> layers = decode_tile(tile);
  if (!layers) {
    return Result::kRefused;  // before anything is forgotten for it
  }
  if (is_of_another_map) {
    begin(geometry, tile.map_session);
  }
  write_tile(*layers, tile.tile_column, tile.tile_row, grid_);
  received_ += revisions_[index] < 0 ? 1 : 0;
  revisions_[index] = tile.revision;
  if (is_complete()) {
    before_.reset();
  }
  return Result::kChanged;
}

void TileMap::begin(const GridGeometry& geometry, std::int64_t session) {
  if (is_complete()) {
    before_ = std::move(grid_);
  }
  grid_ = OccupancyGrid(geometry);
  revisions_.assign(static_cast<std::size_t>(grid_.tile_columns()) * static_cast<std::size_t>(grid_.tile_rows()), -1);
  received_ = 0;
  session_ = session;
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
