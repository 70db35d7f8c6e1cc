#include "services/controller/safety/facing_wall.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace luminav {
namespace {

constexpr std::array kAcross{-0.9, -0.45, 0.0, 0.45, 0.9};  // where the cone is looked at, in half angles
// Smooth walls send all away from 15 to 25 degrees of incidence on: a flat one is this much farther at the cone's edge
// when it is met at 10.
constexpr double kFacing = 1.1;
constexpr double kStep = 0.02;  // [m]

/// Distance [m] to the first wall along a heading [rad]; nothing within `farthest`, or where the map does not know.
std::optional<double> distance_to_wall(const OccupancyGrid& grid, const Eigen::Vector2d& from, double heading,
                                       double farthest) {
  const Eigen::Vector2d along(std::cos(heading), std::sin(heading));
  for (double distance = 0.0; distance <= farthest; distance += kStep) {
    const Cell cell = grid.geometry.cell_at(from + distance * along);
    if (!grid.geometry.contains(cell)) {
      return std::nullopt;
    }
    const Prior prior = grid.prior[grid.geometry.index(cell)];
    if (prior == Prior::kOccupied) {
      return distance;
    }
    if (prior != Prior::kFree) {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> facing_wall(const OccupancyGrid& grid, const Pose2& world_from_sonar, double half_angle,
                                  double farthest) {
  std::array<double, kAcross.size()> distances{};
  for (std::size_t i = 0; i < kAcross.size(); ++i) {
    const std::optional<double> distance = distance_to_wall(
        grid, world_from_sonar.position(), world_from_sonar.theta + kAcross[i] * half_angle, kFacing * farthest);
    if (!distance) {
      return std::nullopt;
    }
    distances[i] = *distance;
  }
  const auto [nearest, last] = std::minmax_element(distances.begin(), distances.end());
  if (*nearest > farthest || *last > kFacing * *nearest + 0.5 * grid.geometry.resolution) {
    return std::nullopt;
  }
  return *nearest;
}

}  // namespace luminav
