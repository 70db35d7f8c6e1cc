#include "services/surveyor/explore/frontier_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/planner/search/cost_field.hpp"
#include "services/planner/space/configuration_space.hpp"
#include "services/surveyor/explore/unseen_rooms.hpp"

namespace luminav {
namespace {

constexpr int kSeedReach = 6;         // [cells] a robot beside an obstacle starts from the nearest place with room
constexpr double kWindowShare = 0.8;  // half the side of the square that counts as seen from a place, by view_radius
constexpr double kNone = std::numeric_limits<double>::infinity();

ConfigurationSpace space_of(const OccupancyGrid& grid, const FrontierParams& params, const Leniency& leniency,
                            bool unknown_is_free) {
  ConfigurationSpaceParams room;
  room.hard_radius = leniency.room * params.hard_radius;
  room.occupied_log_odds = leniency.occupied_log_odds;
  room.free_log_odds = params.known_log_odds;
  room.unknown_is_free = unknown_is_free;
  return {room, grid, {}, true, !unknown_is_free};
}

/// Lengths [m] of the ways from some cells to all others.
std::vector<double> ways_from(const ConfigurationSpace& space, const std::vector<CostSeed>& seeds) {
  CostField field;
  grow_cost_field(space.terrain(), seeds, {}, field);
  const double metres = space.geometry().resolution / (5.0 * ConfigurationSpace::kFreePrice);
  std::vector<double> ways(field.stored.size(), kNone);
  for (std::size_t i = 0; i < ways.size(); ++i) {
    ways[i] = field.is_reached(i) ? metres * field.cost(i) : kNone;
  }
  return ways;
}

std::vector<CostSeed> seeds_near(const ConfigurationSpace& space, const Cell& robot) {
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
  return seeds;
}

}  // namespace

FrontierSearch::FrontierSearch(const FrontierParams& params, const OccupancyGrid& grid, const Leniency& leniency,
                               const std::vector<Eigen::Vector2d>& looks, const TriedFloor& tried,
                               const Eigen::Vector2d& robot)
    : params_(params), min_gain_(leniency.min_gain), geometry_(grid.geometry), worth_(geometry_.size(), 0.0) {
  const ConfigurationSpace known = space_of(grid, params, {params.occupied_log_odds}, false);
  ways_ = ways_from(known, seeds_near(known, geometry_.cell_at(robot)));
  find_open(grid, leniency, looks);
  lower_what_was_tried(tried);
  count_frontiers();
  sum_up();
  choose_best();
}

void FrontierSearch::find_open(const OccupancyGrid& grid, const Leniency& leniency,
                               const std::vector<Eigen::Vector2d>& looks) {
  const double cell_area = geometry_.resolution * geometry_.resolution;
  std::vector<std::uint8_t> seen(geometry_.size(), 0);
  mark_around(looks, params_.view_radius, seen);
  std::vector<CostSeed> reached;
  std::vector<std::uint8_t> is_reached(geometry_.size(), 0);
  for (std::size_t i = 0; i < ways_.size(); ++i) {
    if (ways_[i] < kNone) {
      is_reached[i] = 1;
      floor_.reachable += cell_area;
      worth_[i] = seen[i] == 0 ? cell_area : 0.0;
      floor_.unseen += worth_[i];
      reached.push_back({cell_of(i), 0});
    }
  }
  const ConfigurationSpace passable = space_of(grid, params_, leniency, true);
  const ConfigurationSpace roomy = space_of(grid, params_, {leniency.occupied_log_odds}, true);
  const std::vector<double> beyond = ways_from(passable, reached);
  rooms_ = find_unseen_rooms(roomy, is_reached, params_.room_area);
  for (std::size_t i = 0; i < beyond.size(); ++i) {
    if (beyond[i] > 0.0 && beyond[i] <= params_.frontier_depth && ways_[i] == kNone && !roomy.is_blocked(cell_of(i)) &&
        (rooms_[i] != 0 || !leniency.only_rooms)) {
      worth_[i] = params_.frontier_weight * cell_area;
      frontier_.push_back(i);
    }
  }
}

void FrontierSearch::lower_what_was_tried(const TriedFloor& tried) {
  for (std::size_t i = 0; i < worth_.size(); ++i) {
    if (worth_[i] > 0.0) {
      const int tries = tried.tries(geometry_.centre_of(cell_of(i)));
      worth_[i] *= tries < params_.max_tries ? std::pow(params_.retry_share, tries) : 0.0;
    }
  }
}

void FrontierSearch::choose_best() {
  double best = 0.0;
  std::optional<Cell> centre;
  for (std::size_t i = 0; i < ways_.size(); ++i) {
    if (ways_[i] == kNone) {
      continue;
    }
    const double gain = window(cell_of(i));
    const double value = gain / (params_.fixed_cost + ways_[i]);
    if (gain >= min_gain_ && value > best) {
      best = value;
      centre = cell_of(i);
      floor_.best = Prospect{geometry_.centre_of(*centre), gain};
    }
  }
  if (!centre) {
    return;
  }
  best_cells_ = open_cells(*centre);
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& cell : best_cells_) {
    middle += worth_at(cell) / floor_.best->gain * cell;
  }
  // silence takes nothing away along a smooth wall: what is open is to be driven into, not looked at
  floor_.best->position = *std::min_element(best_cells_.begin(), best_cells_.end(),
                                            [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
                                              return (a - middle).squaredNorm() < (b - middle).squaredNorm();
                                            });
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

void FrontierSearch::count_frontiers() {
  std::vector<std::uint8_t> is_open(geometry_.size(), 0);
  for (const std::size_t i : frontier_) {
    is_open[i] = worth_[i] > 0.0 ? 1 : 0;
  }
  std::vector<std::size_t> pending;
  for (const std::size_t begin : frontier_) {
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
    floor_.frontiers += area >= min_gain_ ? 1 : 0;
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

Cell FrontierSearch::cell_of(std::size_t index) const {
  const auto columns = static_cast<std::size_t>(geometry_.columns);
  return {static_cast<int>(index % columns), static_cast<int>(index / columns)};
}

int FrontierSearch::reach() const {
  return static_cast<int>(std::floor(kWindowShare * params_.view_radius / geometry_.resolution));
}

std::vector<Eigen::Vector2d> FrontierSearch::open_cells(const Cell& centre) const {
  std::vector<Eigen::Vector2d> cells;
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

double FrontierSearch::open_share(const std::vector<Eigen::Vector2d>& cells) const {
  const auto open = std::count_if(cells.begin(), cells.end(), [&](const Eigen::Vector2d& position) {
    const Cell cell = geometry_.cell_at(position);
    return geometry_.contains(cell) && (worth_[geometry_.index(cell)] > 0.0 || rooms_[geometry_.index(cell)] != 0);
  });
  return static_cast<double>(open) / std::max<double>(1.0, static_cast<double>(cells.size()));
}

}  // namespace luminav
