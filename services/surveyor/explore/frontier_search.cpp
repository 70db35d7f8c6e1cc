#include "services/surveyor/explore/frontier_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "services/planner/search/cost_field.hpp"
#include "services/planner/space/configuration_space.hpp"

namespace luminav {
namespace {

constexpr int kSeedReach = 6;         // [cells] a robot beside an obstacle starts from the nearest place with room
constexpr double kWindowShare = 0.8;  // half the side of the square that counts as seen from a place, by view_radius
constexpr double kGivenUp = 0.3;      // [m] around a cell that was given up: an estimate may shift the map a little

/// Costs of the way from the robot over known floor with room for it.
CostField ways_from(const ConfigurationSpace& space, const Cell& robot) {
  std::vector<CostSeed> seeds;
  int nearest = kSeedReach * kSeedReach + 1;
  for (int dr = -kSeedReach; dr <= kSeedReach; ++dr) {
    for (int dc = -kSeedReach; dc <= kSeedReach; ++dc) {
      const Cell cell{robot.column + dc, robot.row + dr};
      if (dc * dc + dr * dr < nearest && !space.is_blocked(cell)) {
        nearest = dc * dc + dr * dr;
        seeds = {{cell, 0}};
      }
    }
  }
  CostField field;
  grow_cost_field(space.terrain(), seeds, {}, field);
  return field;
}

}  // namespace

FrontierSearch::FrontierSearch(const FrontierParams& params, const OccupancyGrid& grid, double occupied_log_odds,
                               const std::vector<Eigen::Vector2d>& looks, const std::vector<Eigen::Vector2d>& given_up,
                               const Eigen::Vector2d& robot)
    : params_(params), geometry_(grid.geometry) {
  ConfigurationSpaceParams room;
  room.hard_radius = params.hard_radius;
  room.occupied_log_odds = occupied_log_odds;
  room.free_log_odds = params.known_log_odds;
  ConfigurationSpace known(room, grid, {});
  room.unknown_is_free = true;
  const ConfigurationSpace hoped(room, grid, {}, true, false);
  const CostField ways = ways_from(known, geometry_.cell_at(robot));
  std::vector<std::uint8_t> seen(geometry_.size(), 0);
  mark_around(looks, params.view_radius, seen);
  std::vector<std::uint8_t> left(geometry_.size(), 0);
  mark_around(given_up, kGivenUp, left);

  worth_.assign(geometry_.size(), 0.0);
  std::vector<std::size_t> frontier;
  const double cell_area = geometry_.resolution * geometry_.resolution;
  for (int row = 1; row + 1 < geometry_.rows; ++row) {
    for (int column = 1; column + 1 < geometry_.columns; ++column) {
      const std::size_t i = geometry_.index({column, row});
      const bool is_reached = ways.is_reached(i);
      floor_.reachable += is_reached ? cell_area : 0.0;
      if (left[i] != 0) {
        continue;
      }
      if (is_reached && seen[i] == 0) {
        worth_[i] = cell_area;
        floor_.unseen += cell_area;
      }
      const auto across = static_cast<std::size_t>(geometry_.columns);
      const bool is_beside = ways.is_reached(i - 1) || ways.is_reached(i + 1) || ways.is_reached(i - across) ||
                             ways.is_reached(i + across);
      if (!is_reached && is_beside && known.is_blocked({column, row}) && !hoped.is_blocked({column, row})) {
        worth_[i] = params.frontier_weight * cell_area;
        frontier.push_back(i);
      }
    }
  }
  count_frontiers(frontier);
  sum_up();
  double best = 0.0;
  const double metres = geometry_.resolution / (5.0 * ConfigurationSpace::kFreePrice);
  for (std::size_t i = 0; i < geometry_.size(); ++i) {
    if (!ways.is_reached(i)) {
      continue;
    }
    const Cell cell{static_cast<int>(i) % geometry_.columns, static_cast<int>(i) / geometry_.columns};
    const double gain = window(cell);
    const double value = gain / (params.fixed_cost + metres * ways.cost(i));
    if (gain >= params.min_gain && value > best) {
      best = value;
      floor_.best = {geometry_.centre_of(cell), gain};
    }
  }
}

void FrontierSearch::mark_around(const std::vector<Eigen::Vector2d>& points, double radius,
                                 std::vector<std::uint8_t>& marks) const {
  const int reach = static_cast<int>(std::floor(radius / geometry_.resolution));
  for (const Eigen::Vector2d& point : points) {
    const Cell centre = geometry_.cell_at(point);
    for (int dr = -reach; dr <= reach; ++dr) {
      const int width = static_cast<int>(std::sqrt(static_cast<double>(reach * reach - dr * dr)));
      const int row = centre.row + dr;
      const int first = std::max(0, centre.column - width);
      const int last = std::min(geometry_.columns - 1, centre.column + width);
      if (row >= 0 && row < geometry_.rows && first <= last) {
        std::fill_n(marks.begin() + static_cast<std::ptrdiff_t>(geometry_.index({first, row})), last - first + 1, 1);
      }
    }
  }
}

void FrontierSearch::count_frontiers(const std::vector<std::size_t>& frontier) {
  std::vector<std::uint8_t> is_open(geometry_.size(), 0);
  for (const std::size_t i : frontier) {
    is_open[i] = 1;
  }
  std::vector<std::size_t> pending;
  for (const std::size_t begin : frontier) {
    if (is_open[begin] == 0) {
      continue;
    }
    double area = 0.0;
    is_open[begin] = 0;
    pending.push_back(begin);
    while (!pending.empty()) {
      const std::size_t i = pending.back();
      pending.pop_back();
      area += worth_[i];
      for (int dr = -1; dr <= 1; ++dr) {
        for (int dc = -1; dc <= 1; ++dc) {
          const auto next = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + dr * geometry_.columns + dc);
          if (is_open[next] != 0) {
            is_open[next] = 0;
            pending.push_back(next);
          }
        }
      }
    }
    floor_.frontiers += area >= params_.min_gain ? 1 : 0;
  }
}

void FrontierSearch::sum_up() {
  const int columns = geometry_.columns + 1;
  std::vector<double> sums(static_cast<std::size_t>(columns) * static_cast<std::size_t>(geometry_.rows + 1), 0.0);
  for (int row = 0; row < geometry_.rows; ++row) {
    double line = 0.0;
    for (int column = 0; column < geometry_.columns; ++column) {
      line += worth_[geometry_.index({column, row})];
      const auto at =
          static_cast<std::size_t>(row + 1) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column + 1);
      sums[at] = sums[at - static_cast<std::size_t>(columns)] + line;
    }
  }
  sums_ = std::move(sums);
}

double FrontierSearch::window(const Cell& centre) const {
  const auto sum = [&](int column, int row) {
    return sums_[static_cast<std::size_t>(std::clamp(row, 0, geometry_.rows)) *
                     static_cast<std::size_t>(geometry_.columns + 1) +
                 static_cast<std::size_t>(std::clamp(column, 0, geometry_.columns))];
  };
  const int left = centre.column - reach();
  const int right = centre.column + reach() + 1;
  const int low = centre.row - reach();
  const int high = centre.row + reach() + 1;
  return sum(right, high) - sum(left, high) - sum(right, low) + sum(left, low);
}

int FrontierSearch::reach() const {
  return static_cast<int>(std::floor(kWindowShare * params_.view_radius / geometry_.resolution));
}

std::vector<Eigen::Vector2d> FrontierSearch::open_cells(const Eigen::Vector2d& position) const {
  std::vector<Eigen::Vector2d> cells;
  const Cell centre = geometry_.cell_at(position);
  for (int row = centre.row - reach(); row <= centre.row + reach(); ++row) {
    for (int column = centre.column - reach(); column <= centre.column + reach(); ++column) {
      if (geometry_.contains({column, row}) && worth_[geometry_.index({column, row})] > 0.0) {
        cells.push_back(geometry_.centre_of({column, row}));
      }
    }
  }
  return cells;
}

double FrontierSearch::worth_at(const Eigen::Vector2d& position) const {
  const Cell cell = geometry_.cell_at(position);
  return geometry_.contains(cell) ? worth_[geometry_.index(cell)] : 0.0;
}

std::vector<Eigen::Vector2d> FrontierSearch::still_open(const std::vector<Eigen::Vector2d>& cells) const {
  std::vector<Eigen::Vector2d> open;
  std::copy_if(cells.begin(), cells.end(), std::back_inserter(open),
               [&](const Eigen::Vector2d& cell) { return worth_at(cell) > 0.0; });
  return open;
}

double FrontierSearch::gain_of(const std::vector<Eigen::Vector2d>& cells) const {
  double gain = 0.0;
  for (const Eigen::Vector2d& cell : cells) {
    gain += worth_at(cell);
  }
  return gain;
}

}  // namespace luminav
