#include "services/planner/route_planner.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <stdexcept>
#include <utility>

namespace luminav {
namespace {

constexpr std::uint32_t kSeedCostPerCell =
    400;  // twenty cells of free way: a goal in an obstacle is missed by as little as possible
constexpr std::uint32_t kEscapePrice = 60;  // of a blocked cell on the way out, beside 36 for the dearest allowed one
constexpr std::uint32_t kFieldMargin =
    10 * 5 * ConfigurationSpace::kFreePrice;       // ten cells of free way beyond the robot, which seldom goes back
constexpr std::size_t kFewestCellsPerChange = 20;  // where more has changed it is planned anew
constexpr double kBlockedMargin = 0.05;            // [m] less than the hard radius before a path counts as blocked

}  // namespace

RoutePlanner::RoutePlanner(const RoutePlannerParams& params) : params_(params) {
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
    forget_waves();
    return;
  }
  const ConfigurationSpace::Update update = space_.update(grid, suspected);
  changes_.insert(changes_.end(), update.changes.begin(), update.changes.end());
  if (!update.is_local || changes_.size() > grid.geometry.size() / kFewestCellsPerChange) {
    forget_waves();
  }
}

void RoutePlanner::forget_waves() {
  field_goal_.reset();
  tiles_goal_.reset();
  changes_.clear();
}

std::vector<WaveSeed> RoutePlanner::seeds_for(const RouteRequest& request) const {
  const GridGeometry& geometry = space_.geometry();
  const Cell goal = geometry.cell_at(request.goal);
  if (!space_.is_blocked(goal)) {
    return {{goal, 0}};
  }
  std::vector<WaveSeed> seeds;
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

std::vector<std::size_t> RoutePlanner::escape(const Cell& start, const Eigen::Vector2d& robot) const {
  const GridGeometry& geometry = space_.geometry();
  const int reach = static_cast<int>(std::ceil(params_.escape_radius / geometry.resolution));
  const int side = 2 * reach + 1;
  const auto local = [&](const Cell& cell) {
    return static_cast<std::size_t>((cell.row - start.row + reach) * side + cell.column - start.column + reach);
  };
  constexpr std::uint32_t kNever = WaveField::kUnreached;
  std::vector<std::uint32_t> cost(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), kNever);
  std::vector<std::size_t> from(cost.size(), 0);
  using Entry = std::pair<std::uint32_t, std::size_t>;  // cost, cell of the grid
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost[local(start)] = 0;
  open.emplace(0, geometry.index(start));
  std::uint32_t best_total = kNever;
  std::size_t best_cell = geometry.index(start);
  const auto cell_of = [&](std::size_t index) {
    return Cell{static_cast<int>(index % static_cast<std::size_t>(geometry.columns)),
                static_cast<int>(index / static_cast<std::size_t>(geometry.columns))};
  };
  while (!open.empty()) {
    const auto [spent, index] = open.top();
    open.pop();
    const Cell cell = cell_of(index);
    if (spent != cost[local(cell)] || spent >= best_total) {
      continue;
    }
    if (field_.is_reached(index)) {
      if (spent + field_.cost(index) < best_total) {
        best_total = spent + field_.cost(index);
        best_cell = index;
      }
      continue;  // from here on the wave knows the way
    }
    for (int dr = -1; dr <= 1; ++dr) {
      for (int dc = -1; dc <= 1; ++dc) {
        const Cell next{cell.column + dc, cell.row + dr};
        const bool in_window = std::abs(next.column - start.column) <= reach && std::abs(next.row - start.row) <= reach;
        if ((dr == 0 && dc == 0) || !in_window || !geometry.contains(next)) {
          continue;
        }
        const double from_robot = (geometry.centre_of(next) - robot).norm();
        if (space_.is_solid(next) && from_robot > params_.body_radius) {
          continue;
        }
        // the nearer to an obstacle the dearer, so that the way out leads straight away from it
        const double tightness = std::max(0.0, 1.0 - space_.clearance(next) / params_.space.hard_radius);
        const auto price = kEscapePrice + static_cast<std::uint32_t>(4.0 * kEscapePrice * tightness);
        const std::uint32_t total = spent + price * (dr != 0 && dc != 0 ? 7 : 5);
        if (total < cost[local(next)]) {
          cost[local(next)] = total;
          from[local(next)] = index;
          open.emplace(total, geometry.index(next));
        }
      }
    }
  }
  std::vector<std::size_t> cells;
  if (best_total == kNever) {
    return cells;
  }
  for (std::size_t index = best_cell; index != geometry.index(start); index = from[local(cell_of(index))]) {
    cells.push_back(index);
  }
  cells.push_back(geometry.index(start));
  std::reverse(cells.begin(), cells.end());
  return cells;
}

bool RoutePlanner::is_enclosed(const Cell& start, const Eigen::Vector2d& robot) const {
  const GridGeometry& geometry = space_.geometry();
  const int reach = static_cast<int>(std::ceil(params_.escape_radius / geometry.resolution));
  const auto side = static_cast<std::size_t>(2 * reach + 1);
  std::vector<bool> was_there(side * side, false);
  std::vector<Cell> open{start};
  while (!open.empty()) {
    const Cell cell = open.back();
    open.pop_back();
    if (!space_.is_blocked(cell)) {
      return false;
    }
    for (const Cell& next : {Cell{cell.column - 1, cell.row}, Cell{cell.column + 1, cell.row},
                             Cell{cell.column, cell.row - 1}, Cell{cell.column, cell.row + 1}}) {
      const int column = next.column - start.column + reach;
      const int row = next.row - start.row + reach;
      if (std::min(column, row) < 0 || std::max(column, row) > 2 * reach || !geometry.contains(next) ||
          (space_.is_solid(next) && (geometry.centre_of(next) - robot).norm() > params_.body_radius)) {
        continue;
      }
      const std::size_t i = static_cast<std::size_t>(row) * side + static_cast<std::size_t>(column);
      if (!was_there[i]) {
        was_there[i] = true;
        open.push_back(next);
      }
    }
  }
  return true;
}

std::optional<Eigen::Vector2d> RoutePlanner::nearest_reachable(const RouteRequest& request) {
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
  tiles_goal_.reset();
  tiles_.grow(space_.passable(), near);
  std::optional<Eigen::Vector2d> best;
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      const Cell cell{column, row};
      const Eigen::Vector2d point = geometry.centre_of(cell);
      if (space_.passable().test(cell) && tiles_.is_reached(cell) &&
          (!best || (point - request.goal).squaredNorm() < (*best - request.goal).squaredNorm())) {
        best = point;
      }
    }
  }
  return best;
}

std::vector<std::size_t> RoutePlanner::cells_by_tiles(const Cell& start, const std::vector<WaveSeed>& seeds) {
  if (seeds.size() == 1) {
    return cells_by_kept_tiles(start, seeds.front().cell);
  }
  // a goal in an obstacle: the free cell nearest to it that can be reached at all
  const Cell from[] = {start};
  tiles_goal_.reset();
  tiles_.grow(space_.passable(), from);
  const WaveSeed* best = nullptr;
  for (const WaveSeed& seed : seeds) {
    if (tiles_.is_reached(seed.cell) && (best == nullptr || seed.cost < best->cost)) {
      best = &seed;
    }
  }
  std::vector<std::size_t> cells;
  if (best == nullptr) {
    return cells;
  }
  for (const Cell& cell : tiles_.descend(best->cell)) {
    cells.push_back(space_.geometry().index(cell));
  }
  std::reverse(cells.begin(), cells.end());
  return cells;
}

std::vector<std::size_t> RoutePlanner::cells_by_kept_tiles(const Cell& start, const Cell& goal) {
  const GridGeometry& geometry = space_.geometry();
  if (tiles_goal_ == goal) {
    std::vector<Cell> changed;
    for (const PriceChange& change : changes_) {
      changed.push_back({static_cast<int>(change.cell % static_cast<std::size_t>(geometry.columns)),
                         static_cast<int>(change.cell / static_cast<std::size_t>(geometry.columns))});
    }
    tiles_.take_back(space_.passable(), changed);
  } else {
    const Cell goals[] = {goal};
    tiles_.begin(space_.passable(), goals);
  }
  field_goal_.reset();  // what has changed is forgotten here
  changes_.clear();
  tiles_goal_ = goal;
  std::vector<std::size_t> cells;
  if (tiles_.grow_to(start)) {
    for (const Cell& cell : tiles_.descend(start)) {
      cells.push_back(geometry.index(cell));
    }
  }
  return cells;
}

void RoutePlanner::refresh_field(const RouteRequest& request, const std::vector<WaveSeed>& seeds) {
  const GridGeometry& geometry = space_.geometry();
  const Cell start = geometry.cell_at(request.start);
  const bool is_repairable = seeds.size() == 1 && !space_.is_blocked(start);
  WaveStop stop;
  if (!space_.is_blocked(start)) {
    stop = {static_cast<std::int64_t>(geometry.index(start)), kFieldMargin};
  }
  const bool is_kept = is_repairable && field_goal_ == seeds.front().cell;
  if (!is_kept || !repair_wave(space_.terrain(), changes_, stop, field_)) {
    grow_wave(space_.terrain(), seeds, stop, field_);
  }
  forget_waves();
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

Route RoutePlanner::plan_paper(const RouteRequest& request, const std::vector<WaveSeed>& seeds) {
  const GridGeometry& geometry = space_.geometry();
  Route route;
  const auto nearest = std::min_element(seeds.begin(), seeds.end(),
                                        [](const WaveSeed& a, const WaveSeed& b) { return a.cost < b.cost; });
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
  const std::vector<WaveSeed> seeds = seeds_for(request);
  if (seeds.empty()) {
    route.outcome = RouteOutcome::kGoalBlocked;
    route.nearest_reachable = nearest_reachable(request);
    return route;
  }
  if (params_.mode == PlannerMode::kPaper && !space_.is_blocked(start)) {
    route = plan_paper(request, seeds);
  } else {
    const std::size_t start_index = geometry.index(start);
    const bool start_is_free = !space_.is_blocked(start);
    const bool by_tiles = start_is_free && geometry.size() > params_.largest_weighed;
    std::vector<std::size_t> cells;
    if (by_tiles) {
      cells = cells_by_tiles(start, seeds);
    } else {
      refresh_field(request, seeds);
      cells = start_is_free ? std::vector<std::size_t>{start_index} : escape(start, request.start);
      if (!cells.empty()) {
        const std::vector<std::size_t> rest = descend(space_.terrain(), field_, cells.back());
        rest.empty() ? cells.clear() : static_cast<void>(cells.insert(cells.end(), rest.begin() + 1, rest.end()));
      }
    }
    if (!cells.empty()) {
      route.outcome = RouteOutcome::kFound;
      route.points = shape_path(space_, params_.shaping, chain_of(cells, request));
    } else {
      const bool is_goal_at_fault = start_is_free || !is_enclosed(start, request.start);
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
  for (std::size_t i = from; i < points.size(); ++i) {
    const Cell cell = space_.geometry().cell_at(points[i]);
    if (space_.is_solid(cell) || space_.clearance(cell) <= radius + 1e-6) {
      return i;
    }
  }
  return std::nullopt;
}

}  // namespace luminav
