#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/mapper/sonar/echo_filter.hpp"
#include "services/mapper/sonar/sonar_model.hpp"
#include "services/mapper/standing_cells.hpp"

namespace luminav {

struct GridMapperParams {
  SonarModelParams sonar;
  EchoFilterParams filter;
  double occupied_log_odds = 0.8;  ///< a cell above is occupied
  double prior_tolerance = 0.20;   ///< [m] an echo this close to a wall of the building's map comes from that wall
  double explained_share = 0.25;   ///< vote of a cell where another on the same arc is already occupied
  double standing_time = 2.0;      ///< [s] that something must go on answering before it counts as standing there
  double decay_time = 90.0;        ///< [s] until occupied evidence that contradicts the building's map fades; 0 = never
  double dispute_range = 2.0;      ///< [m] walls seen through from farther away are not disputed
  double mirror_range = 3.0;       ///< [m] echoes from farther away were often thrown there by a mirror:
  double mirror_share = 0.5;       ///< vote of those, up to occupied_range, where the building's map is silent
  double surface_cells = 5.0;      ///< cells of a surface that one echo may draw where the building's map is silent
  double arc_sharpness = 2.0;      ///< power to which their odds decide which cells of an arc these are
  double known_log_odds = 0.8;     ///< no cell counts as likelier than that, so that a wall may go on beside itself,
  double narrow_range = 3.0;       ///< [m] up to here; the arcs of farther echoes are wider than a door
  double wall_thickness = 0.2;     ///< [m] behind a cell that answers, where nothing can be known from this side
  double view_distance = 0.05;     ///< [m] that a disc moves, or its reading changes, before it votes there again
  double robot_radius = 0.20;      ///< [m] around the robot nothing can stand
};

/// A reading of one disc of the ring.
struct DiscReading {
  int disc = 0;
  std::int64_t utime = 0;  // [us]
  Pose2 world_from_robot;  // at that instant
  Pose2 world_from_sonar;
  double range = 0.0;  // [m]
  bool has_echo = false;
};

/// Occupancy from sonar beside the building's map. An echo needs only one thing to come from: if a wall of the map, or
/// a cell already known as occupied, explains it, the other cells of its arc get little or nothing. That keeps corners
/// sharp and doors open. Assumes that the poses are right: the caller decides when to trust them.
class GridMapper {
 public:
  /// Clamp of occupied evidence where the building's map says free, until something has stood there for a while.
  static constexpr double kPassingLogOdds = 1.2;

  /// The prior is taken at its own resolution; its geometry is the grid's.
  GridMapper(const GridMapperParams& params, const PriorMap& prior, int discs);

  void integrate(const DiscReading& reading);
  /// Nothing can stand where the robot stands.
  void mark_robot(const Pose2& world_from_robot);
  /// Lets evidence fade that contradicts the building's map; call as often as you like with a growing time [us].
  void decay(std::int64_t utime);
  void clear_evidence();

  [[nodiscard]] const OccupancyGrid& grid() const { return grid_; }
  [[nodiscard]] bool is_occupied(const Cell& cell) const;
  /// What a person would call the map: occupied, free or unknown, both layers together.
  [[nodiscard]] PriorMap combined() const;
  /// Indices (tile_row * tile_columns + tile_column) of tiles touched since the last call, ascending.
  std::vector<int> take_touched_tiles();
  /// Evidence kept from an earlier run; false when the geometry differs.
  [[nodiscard]] bool restore_evidence(const OccupancyGrid& kept);

 private:
  struct View {
    Pose2 world_from_sonar;
    double range = 0.0;  // [m]
  };
  /// Range [m] of each slice of the cone up to what hides the rest.
  [[nodiscard]] SliceRanges visible_ranges(const BeamReading& beam) const;
  /// Angle [rad] between a beam and the normal of the surface that the occupied cells round a cell form, or those of
  /// them that hang together with it: a wall has two faces. Nothing where they form none.
  [[nodiscard]] std::optional<double> incidence_at(const Cell& cell, const Eigen::Vector2d& direction) const;
  /// True if an occupied cell goes on answering. What only walked past hides nothing and throws no sound away.
  [[nodiscard]] bool has_stood(std::size_t cell) const;
  /// Takes evidence from what ought to have answered so near to a disc.
  void look_beside(const DiscReading& reading);
  void vote_occupied(const DiscReading& reading, const SliceRanges& visible);
  /// Makes the cells behind one that answered, as deep as a wall, unknown where they were called free.
  void forget_behind(const Eigen::Vector2d& disc, const Cell& wall);
  /// Odds that an echo from a range [m] came from a cell with that evidence, beside others on its arc.
  [[nodiscard]] double odds_of(std::int8_t evidence, double range) const;
  /// True if a reading says more than the last vote of its disc: from the same place it says the same.
  [[nodiscard]] bool is_new_view(const DiscReading& reading);
  void dispute_walls(const DiscReading& reading);
  void touch(const Eigen::Vector2d& centre, double radius);
  void add(const Cell& cell, double log_odds);
  /// Adds occupied evidence, up to a clamp that depends on how long the cell has answered.
  void add_echo(const Cell& cell, double log_odds, std::int64_t utime);

  GridMapperParams params_;
  OccupancyGrid grid_;
  FreeSpaceModel free_space_;
  EchoFilter filter_;
  StandingCells standing_;
  std::vector<std::uint8_t> near_wall_;     // within prior_tolerance of an occupied prior cell
  std::vector<std::uint8_t> touched_;       // per tile, since take_touched_tiles
  std::vector<std::uint8_t> has_evidence_;  // per tile
  std::unordered_map<std::size_t, std::vector<Eigen::Vector2d>>
      disputes_;                    // [m] robot's places, by cell; never iterated
  std::vector<View> views_;         // per disc, the last that voted
  std::int64_t decayed_until_ = 0;  // [us]
};

}  // namespace luminav
