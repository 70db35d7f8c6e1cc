#include "services/planner/configuration_space.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace luminav {
namespace {

constexpr int kHighestPrice = 36;  // a diagonal step of 7 * 36 still fits the bucket queue's 256

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
      price *= 1.0 + params.clearance_weight * depth * depth;
    }
    table[static_cast<std::size_t>(square)] =
        static_cast<std::uint8_t>(std::min<long>(std::lround(price), kHighestPrice));
  }
  return table;
}

void check(const ConfigurationSpaceParams& params, double resolution) {
  if (!(params.hard_radius >= 0.0) || params.hard_radius / resolution > kDistanceReach - 1) {
    throw std::invalid_argument("configuration space: hard_radius must be between 0 and 14 cells");
  }
  if (!(params.clearance_range > params.hard_radius) || !(params.clearance_weight >= 0.0)) {
    throw std::invalid_argument(
        "configuration space: clearance_range must exceed hard_radius, clearance_weight be at least 0");
  }
}

}  // namespace

ConfigurationSpace::ConfigurationSpace(const ConfigurationSpaceParams& params, const OccupancyGrid& grid,
                                       const std::vector<SuspectedObstacle>& suspected, bool use_evidence)
    : geometry_(grid.geometry) {
  check(params, geometry_.resolution);
  const auto occupied = static_cast<int>(std::lround(params.occupied_log_odds * kEvidencePerLogOdds));
  const auto free = static_cast<int>(std::lround(params.free_log_odds * kEvidencePerLogOdds));
  const std::size_t size = geometry_.size();
  solid_.assign(size, 0);
  std::vector<std::uint8_t> unknown(size, 0);
  for (std::size_t i = 0; i < size; ++i) {
    const int evidence = use_evidence ? grid.evidence[i] : 0;
    const Prior prior = grid.prior[i];
    const bool wall = prior == Prior::kOccupied || (prior == Prior::kDisputed && !params.disputed_is_free);
    solid_[i] = wall || evidence > occupied ? 1 : 0;
    unknown[i] = prior == Prior::kUnknown && evidence > free && !params.unknown_is_free ? 1 : 0;
  }
  for (const SuspectedObstacle& disc : suspected) {
    const Cell centre = geometry_.cell_at(disc.centre);
    const int reach = static_cast<int>(std::ceil(disc.radius / geometry_.resolution));
    for (int row = centre.row - reach; row <= centre.row + reach; ++row) {
      for (int column = centre.column - reach; column <= centre.column + reach; ++column) {
        const Cell cell{column, row};
        if (geometry_.contains(cell) && (geometry_.centre_of(cell) - disc.centre).norm() <= disc.radius) {
          solid_[geometry_.index(cell)] = 1;
        }
      }
    }
  }
  squared_distances(solid_, geometry_.columns, geometry_.rows, squared_distance_);
  const auto table = price_table(params, geometry_.resolution);
  prices_.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    // unknown cells block, but what is beside them was seen: they push nothing away
    prices_[i] = unknown[i] != 0 ? 0 : table[squared_distance_[i]];
    solid_[i] = static_cast<std::uint8_t>(solid_[i] | unknown[i]);
  }
  const auto last_row = static_cast<std::ptrdiff_t>(geometry_.index({0, geometry_.rows - 1}));
  std::fill(prices_.begin(), prices_.begin() + geometry_.columns, std::uint8_t{0});
  std::fill(prices_.begin() + last_row, prices_.end(), std::uint8_t{0});
  for (int row = 0; row < geometry_.rows; ++row) {
    prices_[geometry_.index({0, row})] = 0;
    prices_[geometry_.index({geometry_.columns - 1, row})] = 0;
  }
  for (int square = 0; square < 256; ++square) {
    const double cells = square == kNothingNear ? kDistanceReach + 1 : std::sqrt(square);
    metres_[static_cast<std::size_t>(square)] = static_cast<float>(cells * geometry_.resolution);
  }
}

double ConfigurationSpace::clearance(const Cell& cell) const {
  return geometry_.contains(cell) ? static_cast<double>(metres_[squared_distance_[geometry_.index(cell)]]) : 0.0;
}

double ConfigurationSpace::clearance_at(const Eigen::Vector2d& point_in_world) const {
  const Eigen::Vector2d p = (point_in_world - geometry_.origin) / geometry_.resolution - Eigen::Vector2d(0.5, 0.5);
  const int column = static_cast<int>(std::floor(p.x()));
  const int row = static_cast<int>(std::floor(p.y()));
  const double u = p.x() - column;
  const double v = p.y() - row;
  return (1.0 - v) * ((1.0 - u) * clearance({column, row}) + u * clearance({column + 1, row})) +
         v * ((1.0 - u) * clearance({column, row + 1}) + u * clearance({column + 1, row + 1}));
}

double ConfigurationSpace::price_at(const Eigen::Vector2d& point_in_world) const {
  const Cell cell = geometry_.cell_at(point_in_world);
  return is_blocked(cell) ? kBlockedPrice : static_cast<double>(prices_[geometry_.index(cell)]) / kFreePrice;
}

}  // namespace luminav
