#include "services/mapper/tile_sender.hpp"

#include <functional>
#include <string_view>

#include "services/common/process/channels.hpp"
#include "services/common/tiles/tile_codec.hpp"

namespace luminav {
namespace {

int tiles_along(int cells) {
  return (cells + kTileSide - 1) / kTileSide;
}

}  // namespace

TileSender::TileSender(lcm::LCM& lcm, const TileScheduleParams& params, const GridGeometry& geometry)
    : lcm_(lcm),
      tile_columns_(tiles_along(geometry.columns)),
      tile_rows_(tiles_along(geometry.rows)),
      schedule_(params, tile_columns_ * tile_rows_),
      sent_(static_cast<std::size_t>(tile_columns_) * static_cast<std::size_t>(tile_rows_)) {}

void TileSender::mark_changed(const std::vector<int>& tiles) {
  for (const int tile : tiles) {
    schedule_.mark_changed(tile);
  }
}

bool TileSender::take(const tile_request_t& request) {
  if (request.count < 0 || static_cast<std::size_t>(request.count) > request.tile_column.size() ||
      request.tile_row.size() != request.tile_column.size()) {
    return false;
  }
  if (request.count == 0) {
    schedule_.request_all();
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(request.count); ++i) {
    const int column = request.tile_column[i];
    const int row = request.tile_row[i];
    if (column >= 0 && row >= 0 && column < tile_columns_ && row < tile_rows_) {
      schedule_.request(row * tile_columns_ + column);
    }
  }
  return true;
}

void TileSender::send_due(const OccupancyGrid& grid, std::int64_t utime) {
  for (const int tile : schedule_.due(utime)) {
    send(grid, tile, utime);
  }
}

void TileSender::send(const OccupancyGrid& grid, int tile, std::int64_t utime) {
  const int column = tile % tile_columns_;
  const int row = tile / tile_columns_;
  const TileLayers layers = tile_layers(grid, column, row);
  const std::uint64_t hash =
      std::hash<std::string_view>()({reinterpret_cast<const char*>(layers.data()), layers.size()});
  SentTile& sent = sent_[static_cast<std::size_t>(tile)];
  if (sent.message.revision == 0 || hash != sent.hash) {
    const std::int32_t revision = sent.message.revision + 1;
    sent = {encode_tile(grid.geometry, column, row, layers), hash};
    sent.message.revision = revision;
  }
  sent.message.utime = utime;
  sent.message.map_session = header.map_session;
  sent.message.map_command_id = header.map_command_id;
  sent.message.map_command_result = header.map_command_result;
  lcm_.publish(channels::kGridTile, &sent.message);
}

}  // namespace luminav
