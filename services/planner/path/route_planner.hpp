#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "services/planner/path/path_shaper.hpp"
#include "services/planner/search/cost_field.hpp"
#include "services/planner/search/escape_from_inflation.hpp"
#include "services/planner/space/configuration_space.hpp"

namespace luminav {

enum class PlannerMode { kPaper, kModern };

struct RoutePlannerParams {
  PlannerMode mode = PlannerMode::kModern;
  ConfigurationSpaceParams space;
  PathShapingParams shaping;
  /// Cells of the largest map on which clearance is weighed cell by cell, exactly. On larger ones the tile field gives
  /// a short path, and only its shaping keeps it from the walls. 2 million take about 0.1 s.
  std::size_t largest_weighed = 2'000'000;
  double escape_radius = 1.0;  ///< [m] how far a start beside an obstacle may lead through blocked cells
  double body_radius = 0.22;   ///< [m] what seems to stand this close to the robot's middle cannot be there
};

enum class RouteOutcome { kFound, kGoalOutside, kGoalBlocked, kStartOutside, kStartEnclosed, kUnreachable };

struct RouteRequest {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();  // [m] world
  Eigen::Vector2d goal = Eigen::Vector2d::Zero();   // [m] world
  double tolerance = 0.0;                           // [m] a goal in an obstacle may be replaced by a point this near
};

struct Route {
  RouteOutcome outcome = RouteOutcome::kUnreachable;
  Polyline points;        // from the start to the goal; empty unless kFound
  double cost = 0.0;      // [m of free floor], comparable with cost_of
  double goal_gap = 0.0;  // [m] from the last point to the goal that was asked for
  /// Without a route: the reachable point nearest to the goal.
  std::optional<Eigen::Vector2d> nearest_reachable;
};

/// Plans routes over an occupancy grid: configuration space, a cost field from the goal, and a path shaped from it. The
/// field is kept: as long as the goal stays, a change of the grid costs what it changes, and a new start next to
/// nothing.
class RoutePlanner {
 public:
  explicit RoutePlanner(const RoutePlannerParams& params);

  /// Takes over a new state of the grid and of suspected obstacles.
  void set_grid(const OccupancyGrid& grid, const std::vector<SuspectedObstacle>& suspected, bool use_evidence = true);
  [[nodiscard]] const ConfigurationSpace& space() const { return space_; }

  [[nodiscard]] Route plan(const RouteRequest& request);

  /// Index of the first point from `from` on that cannot be passed any more: a cell of margin less than for planning,
  /// so that a path along the limit does not flicker. Nothing when all of it is passable. A path that begins in a
  /// keep-out zone leads out of it: so far it is not blocked.
  [[nodiscard]] std::optional<std::size_t> first_blocked(const Polyline& points, std::size_t from) const;

 private:
  [[nodiscard]] std::vector<CostSeed> seeds_for(const RouteRequest& request) const;
  /// Escape of a robot whose own cell is blocked.
  [[nodiscard]] EscapeFromInflation escape_from_inflation(const Eigen::Vector2d& robot) const;
  [[nodiscard]] std::optional<Eigen::Vector2d> nearest_reachable(const RouteRequest& request) const;
  [[nodiscard]] Polyline chain_of(const std::vector<std::size_t>& cells, const RouteRequest& request) const;
  [[nodiscard]] Route plan_paper(const RouteRequest& request, const std::vector<CostSeed>& seeds);

  RoutePlannerParams params_;
  ConfigurationSpace space_;
  /// Cells from the start to a seed, both free, by the tile field; empty when no path leads there.
  [[nodiscard]] std::vector<std::size_t> cells_by_tiles(const Cell& start, std::vector<CostSeed> seeds) const;
  /// Drops the kept field: it is to be grown again.
  void forget_field();
  /// Brings the kept field up to date, or grows a new one.
  void refresh_field(const RouteRequest& request, const std::vector<CostSeed>& seeds);

  bool uses_evidence_ = true;
  PathShaper shaper_;
  CostField field_;
  std::optional<Cell> field_goal_;    // of the one seed that the field was grown from; nothing: it is not to be kept
  std::vector<PriceChange> changes_;  // since the field was made
};

}  // namespace luminav
