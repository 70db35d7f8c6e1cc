#include "services/surveyor/floor_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "services/common/configuration/toml_table.hpp"
#include "services/surveyor/fixture_layout.hpp"

namespace luminav {
namespace {

constexpr double kCorridorWidth = 2.2;  // [m]
constexpr double kRoomDepth = 5.5;      // [m] from the corridor to the facade, before rounding to the outer size
constexpr double kRoomWidth = 4.6;      // [m] mean
constexpr double kWall = 0.15;          // [m]
constexpr double kDoorWidth = 1.0;      // [m]
constexpr double kLongestWing = 60.0;   // [m] of corridor between two that cross it

class FloorDraughtsman {
 public:
  explicit FloorDraughtsman(const FloorPlanParams& params)
      : params_(params), rng_(params.seed), layout_(params_, plan_.building) {
    plan_.building.name = params.name;
    plan_.building.ceiling_height = params.ceiling_height;
    plan_.building.search = SearchManner::kWander;  // a floor that is made has no stairs
    GridGeometry& geometry = plan_.map.geometry;
    geometry.resolution = params.resolution;
    geometry.columns = static_cast<int>(std::lround(params.width / params.resolution));
    geometry.rows = static_cast<int>(std::lround(params.depth / params.resolution));
    plan_.map.cells.assign(geometry.size(), Prior::kOccupied);
  }

  FloorPlan draw() {
    const int corridors =
        std::max(1, static_cast<int>(std::lround(params_.depth / (2.0 * kRoomDepth + kCorridorWidth))));
    const double band = params_.depth / corridors;
    room_depth_ = 0.5 * (band - kCorridorWidth);
    draw_crossings(corridors);
    for (int i = 0; i < corridors; ++i) {
      const double corridor = i * band + room_depth_;
      add_corridor({{kWall, corridor}, {params_.width - kWall, corridor + kCorridorWidth}});
      draw_row({i * band, corridor, corridor, i == 0});
      draw_row({corridor + kCorridorWidth, (i + 1) * band, corridor + kCorridorWidth, i + 1 == corridors});
    }
    return std::move(plan_);
  }

 private:
  struct RoomRow {
    double south = 0.0;      // [m]
    double north = 0.0;      // [m]
    double door_wall = 0.0;  // [m] y of the wall towards the corridor: south or north
    bool has_facade = false;
  };

  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(rng_() >> 11) * 0x1p-53; }

  void carve(const FloorRectangle& area) {
    const GridGeometry& geometry = plan_.map.geometry;
    const auto cells = [&](double metres, int max) {
      return std::clamp(static_cast<int>(std::lround(metres / geometry.resolution)), 1, max - 1);
    };
    for (int row = cells(area.low.y(), geometry.rows); row < cells(area.high.y(), geometry.rows); ++row) {
      for (int column = cells(area.low.x(), geometry.columns); column < cells(area.high.x(), geometry.columns);
           ++column) {
        plan_.map.cells[geometry.index({column, row})] = Prior::kFree;
      }
    }
  }

  void add_corridor(const FloorRectangle& corridor) {
    carve(corridor);
    layout_.light_corridor(corridor);
  }

  /// With more than one corridor: one across at each end, and more in long wings, so that there are loops.
  void draw_crossings(int corridors) {
    wings_ = {0.0};
    if (corridors > 1) {
      const int wings = std::max(1, static_cast<int>(std::ceil(params_.width / kLongestWing)));
      for (int i = 0; i <= wings; ++i) {
        const double west = kWall + i * (params_.width - kCorridorWidth - 2.0 * kWall) / wings;
        add_corridor({{west, kWall}, {west + kCorridorWidth, params_.depth - kWall}});
        wings_.push_back(west);
        wings_.push_back(west + kCorridorWidth);
      }
    }
    wings_.push_back(params_.width);
  }

  void draw_row(const RoomRow& row) {
    for (std::size_t i = 0; i + 1 < wings_.size(); i += 2) {
      const double length = wings_[i + 1] - wings_[i];
      const int rooms = static_cast<int>(length / kRoomWidth);
      std::vector<double> walls = {wings_[i] + 0.5 * kWall};  // a crossing's wall is whole, one between rooms shared
      for (int room = 1; room < rooms; ++room) {
        const double shift = 0.25 * kRoomWidth * params_.irregularity;
        if (uniform(0.0, 1.0) >= 0.2 * params_.irregularity) {  // else two rooms became one
          walls.push_back(wings_[i] + length * room / rooms + uniform(-shift, shift));
        }
      }
      walls.push_back(wings_[i + 1] - 0.5 * kWall);
      for (std::size_t room = 0; rooms > 0 && room + 1 < walls.size(); ++room) {
        draw_room(row, walls[room], walls[room + 1]);
      }
    }
  }

  void draw_room(const RoomRow& row, double west, double east) {
    const bool door_in_north = row.door_wall == row.north;
    FloorRectangle room{{west + 0.5 * kWall, row.south}, {east - 0.5 * kWall, row.north}};
    room.low.x() = std::max(room.low.x(), kWall);
    room.high.x() = std::min(room.high.x(), params_.width - kWall);
    // the corridor's wall belongs to the room, the wall to the next row's rooms to both
    (door_in_north ? room.high.y() : room.low.y()) += door_in_north ? -kWall : kWall;
    (door_in_north ? room.low.y() : room.high.y()) +=
        (door_in_north ? 1.0 : -1.0) * (row.has_facade ? 1.0 : 0.5) * kWall;
    carve(room);
    layout_.light_room(room);

    Building& building = plan_.building;
    const double margin = 0.5 * kDoorWidth + 0.3;
    const double door = uniform(room.low.x() + margin, room.high.x() - margin);
    const double inner = door_in_north ? room.high.y() : row.door_wall;
    carve({{door - 0.5 * kDoorWidth, inner - 0.05}, {door + 0.5 * kDoorWidth, inner + kWall + 0.05}});
    const int number = static_cast<int>(building.doors.size()) + 1;
    building.doors.push_back({number, {door, inner + 0.5 * kWall, 0.0}, kDoorWidth});
    building.places.push_back({fmt::format("room {}", number), {room.centre().x(), room.centre().y(), 0.0}, false});
    if (row.has_facade) {
      const double facade = door_in_north ? room.low.y() : room.high.y();
      building.windows.push_back(
          {{room.centre().x(), facade, door_in_north ? 0.5 * kPi : -0.5 * kPi}, 0.6 * room.size().x()});
    }
  }

  const FloorPlanParams params_;
  FloorPlan plan_;
  std::mt19937_64 rng_;
  FixtureLayout layout_;
  double room_depth_ = kRoomDepth;  // [m]
  std::vector<double> wings_;       // [m] x: west and east end of each stretch of rooms
};

/// Free way from a point along a direction until something that is not free [m].
double free_distance(const PriorMap& map, const Eigen::Vector2d& from, const Eigen::Vector2d& direction, double max) {
  double distance = 0.0;
  while (distance < max && map.at(from + distance * direction) == Prior::kFree) {
    distance += map.geometry.resolution;
  }
  return distance;
}

bool has_clearance(const PriorMap& map, const Eigen::Vector2d& position) {
  constexpr double kClearance = 0.75;  // [m] no fixture nearer to a wall
  for (int axis = 0; axis < 2; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      if (free_distance(map, position, sign * Eigen::Vector2d::Unit(axis), kClearance) < kClearance) {
        return false;
      }
    }
  }
  return true;
}

/// Hangs a fixture at each free point of one grid, moved to the middle of what is narrow, unless another one is near.
void light_grid(const PriorMap& map, const FloorPlanParams& params, const Eigen::Vector2d& offset,
                const Building& building, FixtureLayout& layout) {
  constexpr double kCorridor = 3.2;  // [m] narrower than this is lit by one row
  const GridGeometry& geometry = map.geometry;
  const Eigen::Vector2d low = geometry.origin + offset + Eigen::Vector2d::Constant(0.5 * params.pitch);
  const Eigen::Vector2d high = geometry.origin + geometry.resolution * Eigen::Vector2d(geometry.columns, geometry.rows);
  for (double y = low.y(); y < high.y(); y += params.pitch) {
    for (double x = low.x(); x < high.x(); x += params.pitch) {
      Eigen::Vector2d position(x, y);
      if (map.at(position) != Prior::kFree) {
        continue;
      }
      Eigen::Vector2d extent;  // of the free space through here, along x and y
      for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector2d direction = Eigen::Vector2d::Unit(axis);
        const double ahead = free_distance(map, position, direction, 4.0 * params.pitch);
        const double behind = free_distance(map, position, -direction, 4.0 * params.pitch);
        extent[axis] = ahead + behind;
        if (extent[axis] < kCorridor) {
          position += 0.5 * (ahead - behind) * direction;
        }
      }
      const bool is_lit = std::any_of(building.fixtures.begin(), building.fixtures.end(), [&](const Fixture& fixture) {
        return (fixture.world_from_fixture.position() - position).norm() < 0.8 * params.pitch;
      });
      if (!is_lit && has_clearance(map, position)) {
        layout.hang(position, extent.x() >= extent.y() ? 0.0 : 0.5 * kPi, extent.minCoeff() < kCorridor);
      }
    }
  }
}

}  // namespace

FloorPlan make_floor_plan(const FloorPlanParams& params) {
  const double min_depth = 2.0 * 3.0 + kCorridorWidth;
  if (params.width < 2.0 * kRoomWidth + 2.0 * kCorridorWidth || params.depth < min_depth) {
    throw ConfigurationError(fmt::format("size = {} x {} m, must be at least {:.1f} x {:.1f} m: a corridor with rooms",
                                         params.width, params.depth, 2.0 * kRoomWidth + 2.0 * kCorridorWidth,
                                         min_depth));
  }
  return FloorDraughtsman(params).draw();
}

FloorPlan light_map(const PriorMap& map, const FloorPlanParams& params) {
  FloorPlan plan;
  plan.map = map;
  plan.building.name = params.name;
  plan.building.ceiling_height = params.ceiling_height;
  FixtureLayout layout(params, plan.building);
  // First the regular grid, then what it missed: corridors between two of its rows, niches.
  for (const double row_offset : {0.0, 0.5, 0.25, 0.75}) {
    for (const double column_offset : {0.0, 0.5, 0.25, 0.75}) {
      light_grid(map, params, {column_offset * params.pitch, row_offset * params.pitch}, plan.building, layout);
    }
  }
  return plan;
}

}  // namespace luminav
