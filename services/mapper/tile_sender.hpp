#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <luminav/grid_tile_t.hpp>
#include <luminav/tile_request_t.hpp>
#include <string>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/mapper/tile_schedule.hpp"

namespace luminav {

/// Sends a grid as GRID_TILEs. A tile is packed anew only when its cells have changed.
class TileSender {
 public:
  /// What all tiles say beside their cells.
  struct Header {
    std::int64_t map_session = 0;
    std::int64_t map_command_id = 0;
    std::string map_command_result;
  };

  TileSender(lcm::LCM& lcm, const TileScheduleParams& params, const GridGeometry& geometry);

  Header header;
  /// Tiles, by index, of which cells may have changed.
  void mark_changed(const std::vector<int>& tiles);
  /// False for a request of an impossible size.
  [[nodiscard]] bool take(const tile_request_t& request);
  /// Sends what is due at a time [us]: see TileSchedule.
  void send_due(const OccupancyGrid& grid, std::int64_t utime);
  void send(const OccupancyGrid& grid, int tile, std::int64_t utime);

 private:
  struct SentTile {
    grid_tile_t message{};
    std::uint64_t hash = 0;  // of its cells
  };

  lcm::LCM& lcm_;
  int tile_columns_;
  int tile_rows_;
  TileSchedule schedule_;
  std::vector<SentTile> sent_;
};

}  // namespace luminav
