#include "services/controller/search/ceiling_forecast.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/building/distance_transform.hpp"

namespace luminav {
namespace {

constexpr double kCeilingCell = 0.2;  // [m]
constexpr double kBesideWall = 0.55;  // [m] from a wall: the middle of a door of a metre

/// Calls `visit` with each cell whose centre is within `radius` [m] of a point.
template <typename Visit>
void for_cells_within(const GridGeometry& geometry, const Eigen::Vector2d& point, double radius, const Visit& visit) {
  const Cell low = geometry.cell_at(point - Eigen::Vector2d::Constant(radius));
  const Cell high = geometry.cell_at(point + Eigen::Vector2d::Constant(radius));
  for (int row = std::max(0, low.row); row <= std::min(geometry.rows - 1, high.row); ++row) {
    for (int column = std::max(0, low.column); column <= std::min(geometry.columns - 1, high.column); ++column) {
      const double distance = (geometry.centre_of({column, row}) - point).norm();
      if (distance <= radius) {
        visit(geometry.index({column, row}), distance);
      }
    }
  }
}

GridGeometry around_fixtures(const std::vector<Fixture>& fixtures, double margin) {
  GridGeometry geometry;
  if (fixtures.empty()) {
    return geometry;
  }
  Eigen::Vector2d low = fixtures.front().world_from_fixture.position();
  Eigen::Vector2d high = low;
  for (const Fixture& fixture : fixtures) {
    low = low.cwiseMin(fixture.world_from_fixture.position());
    high = high.cwiseMax(fixture.world_from_fixture.position());
  }
  geometry.resolution = kCeilingCell;
  geometry.origin = low - Eigen::Vector2d::Constant(margin);
  geometry.columns = static_cast<int>(std::ceil((high.x() - low.x() + 2.0 * margin) / kCeilingCell));
  geometry.rows = static_cast<int>(std::ceil((high.y() - low.y() + 2.0 * margin) / kCeilingCell));
  return geometry;
}

}  // namespace

CeilingForecast::CeilingForecast(const Building& building, const PriorMap& walls, double view_radius, double clearance)
    : building_(building), seen_(building.seen_from), view_radius_(view_radius) {
  ceiling_ = around_fixtures(building_.fixtures, view_radius + kCeilingCell);
  nearest_.assign(ceiling_.size(), -1);
  std::vector<float> min(ceiling_.size(), 1e9F);
  for (std::size_t i = 0; i < building_.fixtures.size(); ++i) {
    for_cells_within(ceiling_, building_.fixtures[i].world_from_fixture.position(), view_radius + kCeilingCell,
                     [&](std::size_t cell, double distance) {
                       if (static_cast<float>(distance) < min[cell]) {
                         min[cell] = static_cast<float>(distance);
                         nearest_[cell] = static_cast<std::int32_t>(i);
                       }
                     });
  }
  floor_ = walls.geometry;
  std::vector<bool> is_wall(walls.cells.size());
  std::transform(walls.cells.begin(), walls.cells.end(), is_wall.begin(),
                 [](Prior prior) { return prior == Prior::kOccupied; });
  const std::vector<float> squared = squared_distances_to(is_wall, static_cast<std::size_t>(floor_.columns));
  room_.resize(squared.size());
  for (std::size_t i = 0; i < room_.size(); ++i) {
    const double distance = std::sqrt(static_cast<double>(squared[i])) * floor_.resolution;
    room_[i] = walls.cells[i] != Prior::kFree || distance <= clearance ? Room::kNone
               : distance <= kBesideWall                               ? Room::kBesideWall
                                                                       : Room::kOpen;
  }
}

const Fixture* CeilingForecast::fixture_above(const Eigen::Vector2d& place) const {
  const Cell cell = ceiling_.cell_at(place);
  const std::int32_t index = ceiling_.contains(cell) ? nearest_[ceiling_.index(cell)] : -1;
  if (index < 0) {
    return nullptr;
  }
  const Fixture& fixture = building_.fixtures[static_cast<std::size_t>(index)];
  return (fixture.world_from_fixture.position() - place).norm() <= view_radius_ ? &fixture : nullptr;
}

bool CeilingForecast::knows(const Eigen::Vector2d& place) const {
  return building_.is_complete || seen_.contains(place) || fixture_above(place) != nullptr;
}

CeilingForecast::Room CeilingForecast::room_at(const Eigen::Vector2d& place) const {
  if (room_.empty()) {
    return Room::kOpen;
  }
  const Cell cell = floor_.cell_at(place);
  return floor_.contains(cell) ? room_[floor_.index(cell)] : Room::kNone;
}

bool CeilingForecast::has_room(const Eigen::Vector2d& place) const {
  return room_at(place) != Room::kNone;
}

bool CeilingForecast::is_beside_wall(const Eigen::Vector2d& place) const {
  return room_at(place) == Room::kBesideWall;
}

}  // namespace luminav
