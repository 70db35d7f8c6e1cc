#include "services/planner/space/configuration_space.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "services/common/geometry/rounding.hpp"
#include "services/planner/space/cell_reading.hpp"

namespace luminav {
namespace {

CellWindow united(const CellWindow& a, const CellWindow& b) {
  return {std::min(a.first_column, b.first_column), std::max(a.last_column, b.last_column),
          std::min(a.first_row, b.first_row), std::max(a.last_row, b.last_row)};
}

/// Price of a cell by its squared distance; 0 = blocked.
std::array<std::uint8_t, 256> price_table(const ConfigurationSpaceParams& params, double resolution) {
  std::array<std::uint8_t, 256> table{};
  const double hard = params.hard_radius / resolution;
  const double range = std::min<double>(params.clearance_range / resolution, kDistanceReach);
  for (int square = 0; square < 256; ++square) {
    const double distance = std::sqrt(square);
    double price = ConfigurationSpace::kFreePrice;
    if (square <= hard * hard + 1e-6) {
      price = 0.0;
    } else if (square != kNothingNear && distance < range) {
      const double depth = (range - distance) / (range - hard);
      price *= 1.0 + params.clearance_weight * depth;
    }
    table[static_cast<std::size_t>(square)] = static_cast<std::uint8_t>(std::lround(price));
  }
  return table;
}

void check(const ConfigurationSpaceParams& params, double resolution) {
  if (!(params.hard_radius >= 0.0) || params.hard_radius / resolution > kDistanceReach - 1) {
    throw std::invalid_argument("configuration space: hard_radius must be between 0 and 14 cells");
  }
  if (!(params.clearance_range > params.hard_radius) || !(params.clearance_weight >= 0.0) ||
      params.clearance_weight > ConfigurationSpace::kMaxDetour - 1.0 + 1e-9) {
    throw std::invalid_argument(
        "configuration space: clearance_range must exceed hard_radius, clearance_weight be 0 to 0.3");
  }
}

}  // namespace

ConfigurationSpace::ConfigurationSpace(const ConfigurationSpaceParams& params, const OccupancyGrid& grid,
                                       const std::vector<SuspectedObstacle>& suspected, bool use_evidence,
                                       bool is_weighed)
    : params_(params),
      use_evidence_(use_evidence),
      is_graded_(is_weighed && params.clearance_weight > 0.0),
      geometry_(grid.geometry),
      solid_(geometry_.columns, geometry_.rows),
      unknown_(geometry_.columns, geometry_.rows),
      passable_(geometry_.columns, geometry_.rows),
      lanes_(params.zones, geometry_) {
  check(params, geometry_.resolution);
  price_ = price_table(params, geometry_.resolution);
  for (int square = 0; square < 256; ++square) {
    const double cells = square == kNothingNear ? kDistanceReach + 1 : std::sqrt(square);
    metres_[static_cast<std::size_t>(square)] = static_cast<float>(cells * geometry_.resolution);
  }
  draw_zones();
  // some rows at a time: what has just been read is still in the cache when it is widened
  constexpr int kRowsAtOnce = 64;
  for (int first = 0, read_to = 0; first < geometry_.rows; first += kRowsAtOnce) {
    const int last = std::min(first + kRowsAtOnce, geometry_.rows);
    const int needed = std::min(last + kDistanceReach, geometry_.rows);
    read(grid, suspected, read_to, needed, solid_, unknown_);
    add_zones(read_to, needed, solid_, unknown_);
    read_to = needed;
    widen(first, last);
  }
  if (is_graded_) {
    squared_distance_ = squared_distances(solid_);
  }
}

void ConfigurationSpace::read(const OccupancyGrid& grid, const std::vector<SuspectedObstacle>& suspected, int first_row,
                              int last_row, BitGrid& solid, BitGrid& unknown) const {
  const auto evidence_of = [&](double log_odds) {
    const long evidence = std::lround(log_odds * kEvidencePerLogOdds);
    return static_cast<std::int8_t>(std::clamp(evidence, -128L, 127L));
  };
  CellReading reading;
  reading.disputed_is_wall = !params_.disputed_is_free;
  reading.unknown_blocks = !params_.unknown_is_free;
  if (use_evidence_) {
    reading.occupied = evidence_of(params_.occupied_log_odds);
    reading.not_free = evidence_of(params_.free_log_odds);
  }
  for (int row = first_row; row < last_row; ++row) {
    const std::size_t first = geometry_.index({0, row});
    read_cells(reading, grid.prior.data() + first, grid.evidence.data() + first, geometry_.columns, solid.row(row),
               unknown.row(row));
  }
  for (const SuspectedObstacle& disc : suspected) {
    const Cell centre = geometry_.cell_at(disc.centre);
    const int reach = static_cast<int>(std::ceil(disc.radius / geometry_.resolution));
    for (int row = std::max(first_row, centre.row - reach); row <= std::min(last_row - 1, centre.row + reach); ++row) {
      for (int column = centre.column - reach; column <= centre.column + reach; ++column) {
        const Cell cell{column, row};
        if (geometry_.contains(cell) && (geometry_.centre_of(cell) - disc.centre).norm() <= disc.radius) {
          solid.set(cell);
        }
      }
    }
  }
}

void ConfigurationSpace::draw_zones() {
  const double touched = std::sqrt(0.5) * geometry_.resolution;  // from a cell's centre to its corner
  for (const Zone& zone : params_.zones) {
    if (zone.kind != ZoneKind::kKeepOut) {
      continue;
    }
    if (zones_.rows() == 0) {
      zones_ = BitGrid(geometry_.columns, geometry_.rows);
      keep_out_ = BitGrid(geometry_.columns, geometry_.rows);
    }
    Eigen::Vector2d low = zone.polygon.front();
    Eigen::Vector2d high = low;
    for (const Eigen::Vector2d& corner : zone.polygon) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
    const Cell first = geometry_.cell_at(low);
    const Cell last = geometry_.cell_at(high);
    for (int row = std::max(0, first.row - 1); row <= std::min(geometry_.rows - 1, last.row + 1); ++row) {
      for (int column = std::max(0, first.column - 1); column <= std::min(geometry_.columns - 1, last.column + 1);
           ++column) {
        const Eigen::Vector2d centre = geometry_.centre_of({column, row});
        if (contains(zone.polygon, centre) || distance_to_edge(zone.polygon, centre) <= touched) {
          zones_.set({column, row});
        }
      }
    }
  }
}

void ConfigurationSpace::add_zones(int first_row, int last_row, BitGrid& solid, const BitGrid& unknown) {
  if (zones_.rows() == 0) {
    return;
  }
  for (int row = first_row; row < last_row; ++row) {
    for (std::size_t i = 0; i < zones_.words_per_row(); ++i) {
      const std::uint64_t zone = zones_.row(row)[i];
      keep_out_.row(row)[i] = zone & ~solid.row(row)[i] & ~unknown.row(row)[i];
      solid.row(row)[i] |= zone;
    }
  }
}

// Unknown cells block, but what is beside them was seen: they push nothing away.
void ConfigurationSpace::widen(int first_row, int last_row) {
  dilate(solid_, params_.hard_radius / geometry_.resolution, first_row, last_row, passable_);
  const std::size_t words = passable_.words_per_row();
  const int last_column = geometry_.columns - 1;
  for (int row = first_row; row < last_row; ++row) {
    std::uint64_t* bits = passable_.row(row);
    if (row == 0 || row == geometry_.rows - 1) {
      std::fill(bits, bits + words, std::uint64_t{0});
      continue;
    }
    const std::uint64_t* unknown = unknown_.row(row);
    for (std::size_t i = 0; i < words; ++i) {
      bits[i] = ~(bits[i] | unknown[i]);
    }
    bits[0] &= ~std::uint64_t{1};
    bits[words - 1] &= (std::uint64_t{1} << (last_column % 64)) - 1;  // neither the last column nor what is beyond
  }
}

std::uint8_t ConfigurationSpace::squared_distance(const Cell& cell) const {
  if (squared_distance_.empty()) {
    squared_distance_ = squared_distances(solid_);
  }
  return squared_distance_[geometry_.index(cell)];
}

CostTerrain ConfigurationSpace::terrain() const {
  return {&passable_, is_graded_ ? squared_distance_.data() : nullptr,
          is_graded_ ? price_.data() : price_.data() + kNothingNear, lanes_.forbidden()};
}

int ConfigurationSpace::price(const Cell& cell) const {
  if (is_blocked(cell)) {
    return 0;
  }
  return params_.clearance_weight > 0.0 ? price_[squared_distance(cell)] : kFreePrice;
}

ConfigurationSpace::Update ConfigurationSpace::update(const OccupancyGrid& grid,
                                                      const std::vector<SuspectedObstacle>& suspected) {
  if (!(grid.geometry == geometry_) || geometry_.size() == 0) {
    *this = ConfigurationSpace(params_, grid, suspected, use_evidence_, is_graded_);
    return {};
  }
  BitGrid solid(geometry_.columns, geometry_.rows);
  BitGrid unknown(geometry_.columns, geometry_.rows);
  read(grid, suspected, 0, geometry_.rows, solid, unknown);
  add_zones(0, geometry_.rows, solid, unknown);
  const CellWindow in_solid = difference(solid, solid_);
  const CellWindow in_unknown = difference(unknown, unknown_);
  if (in_solid.is_empty() && in_unknown.is_empty()) {
    return {.is_local = true, .changes = {}, .window = {}};
  }
  const CellWindow window = in_solid.is_empty() ? in_unknown
                            : in_unknown.is_empty()
                                ? in_solid.grown(kDistanceReach, geometry_.columns, geometry_.rows)
                                : united(in_solid.grown(kDistanceReach, geometry_.columns, geometry_.rows), in_unknown);
  const auto price_at = [&](const Cell& cell) {
    return static_cast<std::uint8_t>(!passable_.test(cell) ? 0
                                     : is_graded_          ? price_[squared_distance_[geometry_.index(cell)]]
                                                           : kFreePrice);
  };
  std::vector<std::uint8_t> before;
  for (int row = window.first_row; row < window.last_row; ++row) {
    for (int column = window.first_column; column < window.last_column; ++column) {
      before.push_back(price_at({column, row}));
    }
  }
  solid_ = std::move(solid);
  unknown_ = std::move(unknown);
  widen(window.first_row, window.last_row);
  if (!squared_distance_.empty()) {
    update_squared_distances(solid_, window, squared_distance_.data());
  }
  Update update{.is_local = true, .changes = {}, .window = window};
  std::size_t i = 0;
  for (int row = window.first_row; row < window.last_row; ++row) {
    for (int column = window.first_column; column < window.last_column; ++column, ++i) {
      if (price_at({column, row}) != before[i]) {
        update.changes.push_back({static_cast<std::uint32_t>(geometry_.index({column, row})), before[i]});
      }
    }
  }
  return update;
}

double ConfigurationSpace::clearance(const Cell& cell) const {
  return geometry_.contains(cell) ? static_cast<double>(metres_[squared_distance(cell)]) : 0.0;
}

double ConfigurationSpace::clearance_at(const Eigen::Vector2d& point_in_world) const {
  const Eigen::Vector2d p = (point_in_world - geometry_.origin) / geometry_.resolution - Eigen::Vector2d(0.5, 0.5);
  const int column = floor_to_int(p.x());
  const int row = floor_to_int(p.y());
  const double u = p.x() - column;
  const double v = p.y() - row;
  return (1.0 - v) * ((1.0 - u) * clearance({column, row}) + u * clearance({column + 1, row})) +
         v * ((1.0 - u) * clearance({column, row + 1}) + u * clearance({column + 1, row + 1}));
}

double ConfigurationSpace::price_at(const Eigen::Vector2d& point_in_world) const {
  const Cell cell = geometry_.cell_at(point_in_world);
  return is_blocked(cell) ? kBlockedPrice : static_cast<double>(price(cell)) / kFreePrice;
}

}  // namespace luminav
