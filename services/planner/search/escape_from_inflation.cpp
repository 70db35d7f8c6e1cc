#include "services/planner/search/escape_from_inflation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <queue>
#include <utility>

#include "services/planner/search/grid_steps.hpp"

namespace luminav {
namespace {

constexpr std::uint32_t kPrice = 15 * ConfigurationSpace::kFreePrice;  // of a blocked cell: it is to be left soon
constexpr std::uint32_t kNever = CostField::kUnreached;

}  // namespace

EscapeFromInflation::EscapeFromInflation(const ConfigurationSpace& space, const EscapeFromInflationParams& params,
                                         const Eigen::Vector2d& robot)
    : space_(space),
      params_(params),
      robot_(robot),
      start_(space.geometry().cell_at(robot)),
      starts_in_zone_(space.is_keep_out(start_)),
      reach_(static_cast<int>(std::ceil((starts_in_zone_ ? std::max(params.reach, params.zone_reach) : params.reach) /
                                        space.geometry().resolution))) {}

std::size_t EscapeFromInflation::cells_in_reach() const {
  const auto side = static_cast<std::size_t>(2 * reach_ + 1);
  return side * side;
}

std::size_t EscapeFromInflation::local(const Cell& cell) const {
  return static_cast<std::size_t>((cell.row - start_.row + reach_) * (2 * reach_ + 1) + cell.column - start_.column +
                                  reach_);
}

Cell EscapeFromInflation::cell_of(std::size_t index) const {
  const auto columns = static_cast<std::size_t>(space_.geometry().columns);
  return {static_cast<int>(index % columns), static_cast<int>(index / columns)};
}

bool EscapeFromInflation::may_enter(const Cell& cell) const {
  const GridGeometry& geometry = space_.geometry();
  if (std::max(std::abs(cell.column - start_.column), std::abs(cell.row - start_.row)) > reach_ ||
      !geometry.contains(cell)) {
    return false;
  }
  return !space_.is_solid(cell) || (starts_in_zone_ && space_.is_keep_out(cell)) ||
         (geometry.centre_of(cell) - robot_).norm() <= params_.body_radius;
}

// The nearer to an obstacle the dearer, so that the escape leads straight away from it.
std::uint32_t EscapeFromInflation::price(const Cell& cell) const {
  const double tightness = std::max(0.0, 1.0 - space_.clearance(cell) / params_.hard_radius);
  return kPrice + static_cast<std::uint32_t>(4.0 * kPrice * tightness);
}

std::vector<std::size_t> EscapeFromInflation::find(const CostField& field) const {
  const GridGeometry& geometry = space_.geometry();
  std::vector<std::uint32_t> cost(cells_in_reach(), kNever);
  std::vector<std::size_t> from(cost.size(), 0);
  using Entry = std::pair<std::uint32_t, std::size_t>;  // cost, cell of the grid
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost[local(start_)] = 0;
  open.emplace(0, geometry.index(start_));
  std::uint32_t min = kNever;  // to the goal
  std::size_t end = geometry.index(start_);
  const auto offer = [&](const Cell& next, std::uint32_t spent, std::size_t before) {
    if (spent < cost[local(next)]) {
      cost[local(next)] = spent;
      from[local(next)] = before;
      open.emplace(spent, geometry.index(next));
    }
  };
  while (!open.empty()) {
    const auto [spent, index] = open.top();
    open.pop();
    const Cell cell = cell_of(index);
    if (spent != cost[local(cell)] || spent >= min) {
      continue;
    }
    if (field.is_reached(index)) {
      if (spent + field.cost(index) < min) {
        min = spent + field.cost(index);
        end = index;
      }
      continue;  // from here on the field gives the path
    }
    for (int row = -1; row <= 1; ++row) {
      for (int column = -1; column <= 1; ++column) {
        const Cell next{cell.column + column, cell.row + row};
        if (!(next == cell) && may_enter(next) &&
            !space_.lanes().is_against(geometry.centre_of(cell), geometry.centre_of(next))) {
          offer(next, spent + price(next) * (row != 0 && column != 0 ? kDiagonal : kStraight), index);
        }
      }
    }
  }
  std::vector<std::size_t> cells;
  if (min == kNever) {
    return cells;
  }
  for (std::size_t index = end; index != geometry.index(start_); index = from[local(cell_of(index))]) {
    cells.push_back(index);
  }
  cells.push_back(geometry.index(start_));
  std::reverse(cells.begin(), cells.end());
  return cells;
}

bool EscapeFromInflation::is_enclosed() const {
  std::vector<bool> was_there(cells_in_reach(), false);
  std::vector<Cell> open{start_};
  while (!open.empty()) {
    const Cell cell = open.back();
    open.pop_back();
    if (!space_.is_blocked(cell)) {
      return false;
    }
    for (const Cell& next : {Cell{cell.column - 1, cell.row}, Cell{cell.column + 1, cell.row},
                             Cell{cell.column, cell.row - 1}, Cell{cell.column, cell.row + 1}}) {
      if (may_enter(next) && !was_there[local(next)]) {
        was_there[local(next)] = true;
        open.push_back(next);
      }
    }
  }
  return true;
}

}  // namespace luminav
