#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/common/ceiling/seen_ceiling.hpp"

namespace luminav {

/// What the building's file predicts of a place: the fixture seen above it, and whether there is room to stand.
class CeilingForecast {
 public:
  /// Predicts nothing.
  CeilingForecast() = default;
  /// A fixture is seen from within `view_radius` [m] of its centre; `clearance` [m] is kept from the walls. Without
  /// walls (an empty map) there is room everywhere.
  CeilingForecast(const Building& building, const PriorMap& walls, double view_radius, double clearance);

  [[nodiscard]] bool is_empty() const { return building_.fixtures.empty(); }
  /// The fixture nearest to a place [m, world] among those seen from there; nullptr = none.
  [[nodiscard]] const Fixture* fixture_above(const Eigen::Vector2d& place) const;
  /// True where the file tells what there is: everywhere, or where a survey that lists a part was.
  [[nodiscard]] bool knows(const Eigen::Vector2d& place) const;
  [[nodiscard]] double view_radius() const { return view_radius_; }
  [[nodiscard]] bool has_room(const Eigen::Vector2d& place) const;
  /// There is room, and a wall so near that its echoes may be drawn there, as into a doorway between its posts.
  [[nodiscard]] bool is_beside_wall(const Eigen::Vector2d& place) const;

 private:
  enum class Room : std::uint8_t { kNone, kBesideWall, kOpen };
  [[nodiscard]] Room room_at(const Eigen::Vector2d& place) const;

  Building building_;
  SeenCeiling seen_{{}};
  double view_radius_ = 0.0;           // [m]
  GridGeometry ceiling_;               // of `nearest_`
  std::vector<std::int32_t> nearest_;  // fixture whose centre is nearest to the cell's, -1 = none is near
  GridGeometry floor_;                 // of `room_`
  std::vector<Room> room_;             // empty = open everywhere
};

}  // namespace luminav
