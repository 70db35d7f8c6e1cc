#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/building/lane_map.hpp"
#include "services/common/building/occupancy_grid.hpp"
#include "services/planner/space/bit_grid.hpp"
#include "services/planner/space/cost_terrain.hpp"
#include "services/planner/space/distance_field.hpp"

namespace luminav {

struct ConfigurationSpaceParams {
  double hard_radius = 0.30;       ///< [m] cells whose centre is this close to an occupied one are blocked
  double clearance_range = 1.2;    ///< [m] nearer than this a cell costs more, so that paths keep to the middle
  double clearance_weight = 0.3;   ///< share of a free cell's price that the nearest allowed one costs in addition
  double occupied_log_odds = 0.8;  ///< evidence above makes a cell occupied
  double free_log_odds = -0.6;     ///< evidence below makes a cell free of which the building's map knows nothing
  bool unknown_is_free = false;    ///< plan through what nobody has seen
  bool disputed_is_free = false;   ///< plan through walls that the sonars saw through
  /// Of the building: keep-out zones are solid to every path but that of a robot which is inside, one-way zones are
  /// driven through in their direction only; the others do not count here.
  std::vector<Zone> zones{};
};

/// A disc that counts as occupied for a while: something stopped the robot there that no sonar shows.
struct SuspectedObstacle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // [m] world
  double radius = 0.15;                              // [m]
};

/// Where the middle of the robot may be, and what it costs to be there. Distances are measured between centres of
/// cells. What blocks is kept and widened as bits; distances are measured when they are first asked for, unless prices
/// depend on them.
class ConfigurationSpace {
 public:
  /// Price of a cell far from everything; a step costs price times 5 (straight) or 7 (diagonal).
  static constexpr int kFreePrice = 10;
  /// A path's cost is at least its length and at most so many times that. So the cheapest path is at most so many times
  /// as long as the shortest one, whatever doors and gaps that one leads through.
  static constexpr double kMaxDetour = 1.3;

  ConfigurationSpace() = default;
  /// `use_evidence` false gives the world as the building's map has it; `is_weighed` false saves a pass over the grid:
  /// `terrain` has one price then, while `price` still knows every cell's own.
  ConfigurationSpace(const ConfigurationSpaceParams& params, const OccupancyGrid& grid,
                     const std::vector<SuspectedObstacle>& suspected, bool use_evidence = true, bool is_weighed = true);

  struct Update {
    bool is_local = false;  // false: everything may have changed
    std::vector<PriceChange> changes;
    CellWindow window;  // where they lie, and every cell whose distance is another now; empty: nothing has changed
  };
  /// Takes over a new state of the grid, and says which cells have another price now. Reading the grid costs a pass
  /// over it, the rest only what changed.
  Update update(const OccupancyGrid& grid, const std::vector<SuspectedObstacle>& suspected);

  [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }
  /// For a cost field. Valid until the next update.
  [[nodiscard]] CostTerrain terrain() const;
  [[nodiscard]] const BitGrid& passable() const { return passable_; }
  /// 0 = blocked, else the price of a cell inside the grid. The outermost ring of the grid is always blocked.
  [[nodiscard]] int price(const Cell& cell) const;
  [[nodiscard]] bool is_blocked(const Cell& cell) const { return !geometry_.contains(cell) || !passable_.test(cell); }
  /// Occupied, or unknown while that counts as blocked: not even the robot's edge may be there.
  [[nodiscard]] bool is_solid(const Cell& cell) const {
    return !geometry_.contains(cell) || solid_.test(cell) || unknown_.test(cell);
  }
  /// In a keep-out zone, with nothing solid there besides.
  [[nodiscard]] bool is_keep_out(const Cell& cell) const {
    return keep_out_.rows() > 0 && geometry_.contains(cell) && keep_out_.test(cell);
  }
  [[nodiscard]] const LaneMap& lanes() const { return lanes_; }
  /// Distance [m] from a cell's centre to the nearest occupied cell's; 1.6 m (at 0.1 m a cell) where nothing is near.
  [[nodiscard]] double clearance(const Cell& cell) const;
  /// Clearance [m] at any point, bilinear between cells.
  [[nodiscard]] double clearance_at(const Eigen::Vector2d& point_in_world) const;
  /// Price per metre, 1 = free, at a point; that of a blocked cell is `kBlockedPrice`.
  [[nodiscard]] double price_at(const Eigen::Vector2d& point_in_world) const;
  static constexpr double kBlockedPrice = 60.0;

 private:
  void read(const OccupancyGrid& grid, const std::vector<SuspectedObstacle>& suspected, int first_row, int last_row,
            BitGrid& solid, BitGrid& unknown) const;
  void draw_zones();
  /// Takes the zones' cells into `solid`, and keeps those in which nothing else is.
  void add_zones(int first_row, int last_row, BitGrid& solid, const BitGrid& unknown);
  void widen(int first_row, int last_row);
  [[nodiscard]] std::uint8_t squared_distance(const Cell& cell) const;

  ConfigurationSpaceParams params_;
  bool use_evidence_ = true;
  bool is_graded_ = true;  // all prices are kept up to date
  GridGeometry geometry_;
  BitGrid solid_;
  BitGrid unknown_;  // and not to be entered
  BitGrid passable_;
  BitGrid zones_;     // all cells that a keep-out zone touches; no rows: there is no zone
  BitGrid keep_out_;  // those of them that are free otherwise
  LaneMap lanes_;
  mutable std::vector<std::uint8_t> squared_distance_;  // [cells^2]; empty until it is needed
  std::array<std::uint8_t, 256> price_{};               // of each squared distance
  std::array<float, 256> metres_{};                     // of each squared distance
};

}  // namespace luminav
