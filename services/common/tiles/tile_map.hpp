#pragma once

#include <luminav/grid_tile_t.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// Puts GRID_TILEs together to the mapper's grid. What was not received is unknown; of a new map session nothing is
/// shown before all of it is there, as long as there is a whole map of the session before.
class TileMap {
 public:
  enum class Result { kRefused, kUnchanged, kChanged };

  /// A tile of a new map session throws away all others.
  Result add(const grid_tile_t& tile);

  [[nodiscard]] const OccupancyGrid& grid() const { return before_ ? *before_ : grid_; }
  [[nodiscard]] int received() const { return received_; }
  [[nodiscard]] int tiles() const { return static_cast<int>(revisions_.size()); }
  [[nodiscard]] bool is_complete() const { return tiles() > 0 && received_ == tiles(); }
  /// Columns and rows of tiles that are missing, at most `max` of them.
  void missing(std::size_t max, std::vector<std::int32_t>& columns, std::vector<std::int32_t>& rows) const;

 private:
  void begin(const GridGeometry& geometry, std::int64_t session);
  OccupancyGrid grid_;
  std::optional<OccupancyGrid> before_;  // of the session before, until this one's is whole
  std::int64_t session_ = 0;
  std::vector<std::int32_t> revisions_;  // -1 = not received
  int received_ = 0;
};

}  // namespace luminav
