#include "services/planner/path/route_planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "services/planner/search/tile_cost_field.hpp"

namespace luminav {
namespace {

constexpr std::uint32_t kSeedCostPerCell =
    20 * 5 * ConfigurationSpace::kFreePrice;  // twenty cells: a goal in an obstacle is missed by as little as possible
constexpr std::uint32_t kFieldMargin =
    10 * 5 * ConfigurationSpace::kFreePrice;       // ten free cells beyond the robot, which seldom goes back
constexpr std::size_t kFewestCellsPerChange = 20;  // where more has changed it is planned anew
constexpr double kBlockedMargin = 0.05;            // [m] less than the hard radius before a path counts as blocked

}  // namespace

RoutePlanner::RoutePlanner(const RoutePlannerParams& params) : params_(params), shaper_(params.shaping) {
  if (!(params.escape_radius >= 0.0) || !(params.shaping.spacing > 0.0)) {
    throw std::invalid_argument("route planner: escape_radius must be at least 0 m, spacing above 0 m");
  }
}

void RoutePlanner::set_grid(const OccupancyGrid& grid, const std::vector<SuspectedObstacle>& suspected,
                            bool use_evidence) {
  if (use_evidence != uses_evidence_ || !(space_.geometry() == grid.geometry)) {
    const bool is_weighed = params_.mode == PlannerMode::kModern && grid.geometry.size() <= params_.largest_weighed;
    space_ = ConfigurationSpace(params_.space, grid, suspected, use_evidence, is_weighed);
    uses_evidence_ = use_evidence;
    forget_field();
    shaper_.forget();
    return;
  }
  const ConfigurationSpace::Update update = space_.update(grid, suspected);
  changes_.insert(changes_.end(), update.changes.begin(), update.changes.end());
  update.is_local ? shaper_.forget(grid.geometry, update.window) : shaper_.forget();
  if (!update.is_local || changes_.size() > grid.geometry.size() / kFewestCellsPerChange) {
    forget_field();
  }
}

void RoutePlanner::forget_field() {
  field_goal_.reset();
  changes_.clear();
}

std::vector<CostSeed> RoutePlanner::seeds_for(const RouteRequest& request) const {
  const GridGeometry& geometry = space_.geometry();
  const Cell goal = geometry.cell_at(request.goal);
  if (!space_.is_blocked(goal)) {
    return {{goal, 0}};
  }
  std::vector<CostSeed> seeds;
  const int reach = static_cast<int>(std::ceil(request.tolerance / geometry.resolution));
  for (int row = goal.row - reach; row <= goal.row + reach; ++row) {
    for (int column = goal.column - reach; column <= goal.column + reach; ++column) {
      const Cell cell{column, row};
      const double gap = (geometry.centre_of(cell) - request.goal).norm();
      if (!space_.is_blocked(cell) && gap <= request.tolerance) {
        seeds.push_back({cell, static_cast<std::uint32_t>(gap / geometry.resolution * kSeedCostPerCell)});
      }
    }
  }
  return seeds;
}

EscapeFromInflation RoutePlanner::escape_from_inflation(const Eigen::Vector2d& robot) const {
  return {space_, {params_.escape_radius, params_.body_radius, params_.space.hard_radius}, robot};
}

std::optional<Eigen::Vector2d> RoutePlanner::nearest_reachable(const RouteRequest& request) const {
  const GridGeometry& geometry = space_.geometry();
  const Cell start = geometry.cell_at(request.start);
  std::vector<Cell> near;
  const int reach = static_cast<int>(std::ceil(params_.escape_radius / geometry.resolution));
  // beside an obstacle the robot's own cell may be blocked: the nearest free ones stand for it
  for (int ring = 0; ring <= reach && near.empty(); ++ring) {
    for (int row = start.row - ring; row <= start.row + ring; ++row) {
      for (int column = start.column - ring; column <= start.column + ring; ++column) {
        if (!space_.is_blocked({column, row})) {
          near.push_back({column, row});
        }
      }
    }
  }
  TileCostField tiles;
  tiles.grow(space_.passable(), near);
  std::optional<Eigen::Vector2d> best;
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      const Cell cell{column, row};
      const Eigen::Vector2d point = geometry.centre_of(cell);
      if (space_.passable().test(cell) && tiles.is_reached(cell) &&
          (!best || (point - request.goal).squaredNorm() < (*best - request.goal).squaredNorm())) {
        best = point;
      }
    }
  }
  return best;
}

std::vector<std::size_t> RoutePlanner::cells_by_tiles(const Cell& start, std::vector<CostSeed> seeds) const {
  TileCostField tiles;
  std::vector<std::size_t> cells;
  if (seeds.size() > 1) {
    // a goal in an obstacle: the free cell nearest to it that can be reached at all
    tiles.begin(space_.passable(), std::array{start});
    std::stable_sort(seeds.begin(), seeds.end(), [](const CostSeed& a, const CostSeed& b) { return a.cost < b.cost; });
    const auto reached =
        std::find_if(seeds.begin(), seeds.end(), [&](const CostSeed& s) { return tiles.grow_to(s.cell); });
    if (reached == seeds.end()) {
      return cells;
    }
    seeds = {*reached};
  }
  tiles.begin(space_.passable(), std::array{seeds.front().cell});
  if (tiles.grow_to(start)) {
    for (const Cell& cell : tiles.follow_gradient(start)) {
      cells.push_back(space_.geometry().index(cell));
    }
  }
  return cells;
}

void RoutePlanner::refresh_field(const RouteRequest& request, const std::vector<CostSeed>& seeds) {
  const GridGeometry& geometry = space_.geometry();
  const Cell start = geometry.cell_at(request.start);
  const bool is_repairable = seeds.size() == 1 && !space_.is_blocked(start) && space_.lanes().empty();
  CostStop stop;
  if (!space_.is_blocked(start)) {
    stop = {static_cast<std::int64_t>(geometry.index(start)), kFieldMargin};
  }
  const bool is_kept = is_repairable && field_goal_ == seeds.front().cell;
  if (!is_kept || !repair_cost_field(space_.terrain(), changes_, stop, field_)) {
    grow_cost_field(space_.terrain(), seeds, stop, field_);
  }
  forget_field();
  if (is_repairable) {
    field_goal_ = seeds.front().cell;
  }
}

Polyline RoutePlanner::chain_of(const std::vector<std::size_t>& cells, const RouteRequest& request) const {
  const GridGeometry& geometry = space_.geometry();
  Polyline chain;
  chain.reserve(cells.size() + 1);
  for (const std::size_t index : cells) {
    chain.push_back(geometry.centre_of({static_cast<int>(index % static_cast<std::size_t>(geometry.columns)),
                                        static_cast<int>(index / static_cast<std::size_t>(geometry.columns))}));
  }
  // exact ends instead of the middles of their cells
  chain.front() = request.start;
  const Cell goal = geometry.cell_at(request.goal);
  if (!space_.is_blocked(goal)) {
    if (chain.size() == 1) {
      chain.push_back(request.goal);
    } else {
      chain.back() = request.goal;
    }
  }
  return chain;
}

Route RoutePlanner::plan_paper(const RouteRequest& request, const std::vector<CostSeed>& seeds) {
  const GridGeometry& geometry = space_.geometry();
  Route route;
  const auto nearest = std::min_element(seeds.begin(), seeds.end(),
                                        [](const CostSeed& a, const CostSeed& b) { return a.cost < b.cost; });
  const std::size_t start = geometry.index(geometry.cell_at(request.start));
  const auto labels = wavefront_labels(space_.passable(), start, geometry.index(nearest->cell));
  const std::vector<std::size_t> cells = follow_labels(labels, geometry.columns, start);
  if (!cells.empty()) {
    route.outcome = RouteOutcome::kFound;
    route.points = resampled(chain_of(cells, request), params_.shaping.spacing);
  }
  return route;
}

Route RoutePlanner::plan(const RouteRequest& request) {
  const GridGeometry& geometry = space_.geometry();
  Route route;
  const Cell start = geometry.cell_at(request.start);
  if (!geometry.contains(start)) {
    route.outcome = RouteOutcome::kStartOutside;
    return route;
  }
  if (!geometry.contains(geometry.cell_at(request.goal))) {
    route.outcome = RouteOutcome::kGoalOutside;
    return route;
  }
  const std::vector<CostSeed> seeds = seeds_for(request);
  if (seeds.empty()) {
    route.outcome = RouteOutcome::kGoalBlocked;
    route.nearest_reachable = nearest_reachable(request);
    return route;
  }
  const bool has_lanes = !space_.lanes().empty();  // only the exact field knows them
  if (params_.mode == PlannerMode::kPaper && !space_.is_blocked(start) && !has_lanes) {
    route = plan_paper(request, seeds);
  } else {
    const std::size_t start_index = geometry.index(start);
    const bool start_is_free = !space_.is_blocked(start);
    const bool by_tiles = start_is_free && geometry.size() > params_.largest_weighed && !has_lanes;
    std::vector<std::size_t> cells;
    if (by_tiles) {
      forget_field();
      cells = cells_by_tiles(start, seeds);
    } else {
      refresh_field(request, seeds);
      cells = start_is_free ? std::vector<std::size_t>{start_index} : escape_from_inflation(request.start).find(field_);
      if (!cells.empty()) {
        const std::vector<std::size_t> rest = follow_gradient(space_.terrain(), field_, cells.back());
        rest.empty() ? cells.clear() : static_cast<void>(cells.insert(cells.end(), rest.begin() + 1, rest.end()));
      }
    }
    if (!cells.empty()) {
      route.outcome = RouteOutcome::kFound;
      route.points = shaper_.shape(space_, chain_of(cells, request));
    } else {
      const bool is_goal_at_fault = start_is_free || !escape_from_inflation(request.start).is_enclosed();
      route.outcome = is_goal_at_fault ? RouteOutcome::kUnreachable : RouteOutcome::kStartEnclosed;
    }
  }
  if (route.outcome == RouteOutcome::kFound) {
    route.cost = cost_of(space_, route.points);
    route.goal_gap = (route.points.back() - request.goal).norm();
  } else {
    route.nearest_reachable = nearest_reachable(request);
  }
  return route;
}

std::optional<std::size_t> RoutePlanner::first_blocked(const Polyline& points, std::size_t from) const {
  const double radius = params_.space.hard_radius - kBlockedMargin;
  if (from < points.size() && space_.is_keep_out(space_.geometry().cell_at(points[from]))) {
    while (from < points.size() && space_.is_blocked(space_.geometry().cell_at(points[from]))) {
      ++from;
    }
  }
  for (std::size_t i = from; i < points.size(); ++i) {
    const Cell cell = space_.geometry().cell_at(points[i]);
    if (space_.is_solid(cell) || space_.clearance(cell) <= radius + 1e-6) {
      return i;
    }
  }
  return std::nullopt;
}

}  // namespace luminav
