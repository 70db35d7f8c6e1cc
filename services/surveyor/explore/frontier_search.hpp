#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

struct FrontierParams {
  double hard_radius = 0.25;     ///< [m] the robot's middle keeps that far from what is occupied, as the planner's
  double view_radius = 1.0;      ///< [m] round the robot the ceiling was seen when an image was taken
  double known_log_odds = -0.6;  ///< evidence below makes a cell known as free, as the planner's
  double frontier_weight = 5.0;  ///< a cell of unknown floor counts as so many whose ceiling was not seen
  double min_gain = 0.20;        ///< [m^2] less is not worth going for
  double fixed_cost = 1.0;       ///< [m] of way that each goal costs beside its path
};

/// A place and what is to be seen from there.
struct Prospect {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // [m] world, known floor that the robot can reach
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
/// where the robot is; a frontier is unknown floor beside it with room for the robot (Yamauchi 1997), and the ceiling
/// counts as seen around the places where images were taken. `given_up` are cells' centres [m, world] that count no
/// more. What is occupied is what has evidence above `occupied_log_odds`.
class FrontierSearch {
 public:
  FrontierSearch(const FrontierParams& params, const OccupancyGrid& grid, double occupied_log_odds,
                 const std::vector<Eigen::Vector2d>& looks, const std::vector<Eigen::Vector2d>& given_up,
                 const Eigen::Vector2d& robot);

  [[nodiscard]] const OpenFloor& open_floor() const { return floor_; }
  /// Those of some cells [m, world] that are open now, and what they count [m^2].
  [[nodiscard]] std::vector<Eigen::Vector2d> still_open(const std::vector<Eigen::Vector2d>& cells) const;
  [[nodiscard]] double gain_of(const std::vector<Eigen::Vector2d>& cells) const;
  /// Centres [m, world] of the open cells that are to be seen from a place.
  [[nodiscard]] std::vector<Eigen::Vector2d> open_cells(const Eigen::Vector2d& position) const;

 private:
  [[nodiscard]] double worth_at(const Eigen::Vector2d& position) const;  // [m^2]
  void mark_around(const std::vector<Eigen::Vector2d>& points, double radius, std::vector<std::uint8_t>& marks) const;
  void count_frontiers(const std::vector<std::size_t>& frontier);
  void sum_up();
  [[nodiscard]] double window(const Cell& centre) const;
  [[nodiscard]] int reach() const;

  FrontierParams params_;
  GridGeometry geometry_;
  std::vector<double> worth_;  // [m^2] per cell
  std::vector<double> sums_;   // of these from the lower left corner, a row and a column more
  OpenFloor floor_;
};

}  // namespace luminav
