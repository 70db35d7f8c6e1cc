#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/planner/distance_field.hpp"

namespace luminav {

struct ConfigurationSpaceParams {
  double hard_radius = 0.30;       ///< [m] cells whose centre is this close to an occupied one are blocked
  double clearance_range = 1.2;    ///< [m] nearer than this a cell costs more, so that paths keep to the middle
  double clearance_weight = 6.0;   ///< times the price of a free cell that the nearest allowed one costs in addition
  double occupied_log_odds = 0.8;  ///< evidence above makes a cell occupied
  double free_log_odds = -0.6;     ///< evidence below makes a cell free of which the building's map knows nothing
  bool unknown_is_free = false;    ///< plan through what nobody has seen
  bool disputed_is_free = false;   ///< plan through walls that the sonars saw through
};

/// A disc that counts as occupied for a while: something stopped the robot there that no sonar shows.
struct SuspectedObstacle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // [m] world
  double radius = 0.15;                              // [m]
};

/// Where the middle of the robot may be, and what it costs to be there. Distances are measured between centres of
/// cells.
class ConfigurationSpace {
 public:
  /// Price of a cell far from everything; a step costs price times 5 (straight) or 7 (diagonal).
  static constexpr int kFreePrice = 4;

  ConfigurationSpace() = default;
  /// `use_evidence` false gives the world as the building's map has it.
  ConfigurationSpace(const ConfigurationSpaceParams& params, const OccupancyGrid& grid,
                     const std::vector<SuspectedObstacle>& suspected, bool use_evidence = true);

  [[nodiscard]] const GridGeometry& geometry() const { return geometry_; }
  /// Per cell: 0 = blocked, else its price. The outermost ring of the grid is always blocked.
  [[nodiscard]] const std::vector<std::uint8_t>& prices() const { return prices_; }
  [[nodiscard]] bool is_blocked(const Cell& cell) const {
    return !geometry_.contains(cell) || prices_[geometry_.index(cell)] == 0;
  }
  /// Occupied, or unknown while that counts as blocked: not even the robot's edge may be there.
  [[nodiscard]] bool is_solid(const Cell& cell) const {
    return !geometry_.contains(cell) || solid_[geometry_.index(cell)] != 0;
  }
  /// Distance [m] from a cell's centre to the nearest occupied cell's; 1.6 m (at 0.1 m a cell) where nothing is near.
  [[nodiscard]] double clearance(const Cell& cell) const;
  /// The same between cells, bilinear [m].
  [[nodiscard]] double clearance_at(const Eigen::Vector2d& point_in_world) const;
  /// Price per metre, 1 = free, at a point; that of a blocked cell is `kBlockedPrice`.
  [[nodiscard]] double price_at(const Eigen::Vector2d& point_in_world) const;
  static constexpr double kBlockedPrice = 60.0;

 private:
  GridGeometry geometry_;
  std::vector<std::uint8_t> solid_;
  std::vector<std::uint8_t> squared_distance_;
  std::vector<std::uint8_t> prices_;
  std::array<float, 256> metres_{};  // of each squared distance
};

}  // namespace luminav
