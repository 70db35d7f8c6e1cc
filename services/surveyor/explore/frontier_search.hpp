#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"
#include "services/surveyor/explore/tried_floor.hpp"

namespace luminav {

struct FrontierParams {
  double hard_radius = 0.25;       ///< [m] the robot's middle keeps that far from what is occupied, as the planner's
  double occupied_log_odds = 0.8;  ///< evidence above makes a cell occupied, as the planner's
  double known_log_odds = -0.6;    ///< evidence below makes a cell known as free, as the planner's
  double view_radius = 1.0;        ///< [m] round the robot the ceiling was seen when an image was taken
  double frontier_depth = 1.2;     ///< [m] so far beyond floor that it reaches, unknown floor counts
  double frontier_weight = 2.0;    ///< a cell of it counts as so many whose ceiling was not seen
  double fixed_cost = 1.0;         ///< [m] of way that each goal costs beside its path
  double retry_share = 0.5;        ///< what was tried in vain counts by that less each time
  int max_tries = 3;               ///< and no more after so many
  double room_area = 4.0;          ///< [m^2] of unknown floor that hangs together may be a room
};

/// What may be a way although the map has none for the robot there: walls of less evidence, gaps of less width.
struct Leniency {
  double occupied_log_odds = 0.8;  ///< evidence above makes a wall
  double room = 1.0;               ///< share of the hard radius from the middle of a gap to what bounds it
  double min_gain = 0.3;           ///< [m^2] less is not worth going for
  bool only_rooms = false;         ///< a way counts only if what may be a room lies behind it
};

/// A place and what is to be seen from there.
struct Prospect {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // [m] world
  double gain = 0.0;                                   // [m^2] of ceiling not seen yet, unknown floor at its weight
};

/// What is left to see of the floor that can be reached.
struct OpenFloor {
  std::optional<Prospect> best;  // most to see for the way there; nothing: nothing is left
  int frontiers = 0;             // connected borders to the unknown
  double unseen = 0.0;           // [m^2] of reachable floor below ceiling not seen yet
  double reachable = 0.0;        // [m^2]
};

/// Looks where it is worth going: reachable floor is known as free, has room for the robot, and hangs together with
/// where the robot is; a frontier is unknown floor behind it with room for the robot (Yamauchi 1997), and the ceiling
/// counts as seen around the places where images were taken.
class FrontierSearch {
 public:
  FrontierSearch(const FrontierParams& params, const OccupancyGrid& grid, const Leniency& leniency,
                 const std::vector<Eigen::Vector2d>& looks, const TriedFloor& tried, const Eigen::Vector2d& robot);

  [[nodiscard]] const OpenFloor& open_floor() const { return floor_; }
  /// Share of some cells [m, world] that are open still: worth going for, or of what may be a room, though there is no
  /// way there now. Echoes of its posts may draw a door shut while the robot looks at it from near.
  [[nodiscard]] double open_share(const std::vector<Eigen::Vector2d>& cells) const;
  /// Centres [m, world] of the open cells that the best place is for.
  [[nodiscard]] const std::vector<Eigen::Vector2d>& best_cells() const { return best_cells_; }

 private:
  [[nodiscard]] double worth_at(const Eigen::Vector2d& position) const;  // [m^2]
  void mark_around(const std::vector<Eigen::Vector2d>& points, double radius, std::vector<std::uint8_t>& marks) const;
  void find_open(const OccupancyGrid& grid, const Leniency& leniency, const std::vector<Eigen::Vector2d>& looks);
  void lower_what_was_tried(const TriedFloor& tried);
  void count_frontiers();
  void sum_up();
  void choose_best();
  [[nodiscard]] std::vector<Eigen::Vector2d> open_cells(const Cell& centre) const;
  [[nodiscard]] double window(const Cell& centre) const;
  [[nodiscard]] Cell cell_of(std::size_t index) const;
  [[nodiscard]] int reach() const;

  FrontierParams params_;
  double min_gain_;  // [m^2]
  GridGeometry geometry_;
  std::vector<double> ways_;           // [m] from the robot over known floor with room for it; infinite: none
  std::vector<double> worth_;          // [m^2] per cell
  std::vector<std::uint8_t> rooms_;    // per cell: unknown floor that may be a room
  std::vector<std::size_t> frontier_;  // unknown cells behind it
  std::vector<double> sums_;           // of worth_ from the lower left corner, a row and a column more
  OpenFloor floor_;
  std::vector<Eigen::Vector2d> best_cells_;
};

}  // namespace luminav
