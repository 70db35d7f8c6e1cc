#include "services/planner/holding/blockage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luminav {
namespace {

constexpr double kDoorReach = 0.5;       // [m] from a door's opening within which a blockage is the door's
constexpr double kDoorDepth = 0.3;       // [m] before and behind the opening
constexpr double kCrossSection = 1.5;    // [m] to either side of the path where no door is
constexpr std::size_t kLookFurther = 5;  // points of the path that may be the narrowest one

/// The widest stretch [m] without a solid cell along a line through a point.
double widest_gap(const ConfigurationSpace& space, const Eigen::Vector2d& middle, const Eigen::Vector2d& direction,
                  double half) {
  const double step = 0.25 * space.geometry().resolution;
  double widest = 0.0;
  double run = 0.0;
  for (double along = -half; along <= half; along += step) {
    const bool solid = space.is_solid(space.geometry().cell_at(middle + along * direction));
    run = solid ? 0.0 : run + step;
    widest = std::max(widest, run);
  }
  return widest;
}

/// Distance [m] from a point to the opening of a door.
double distance_to(const Door& door, const Eigen::Vector2d& point) {
  const Eigen::Vector2d in_door = door.world_from_door.inverse() * point;
  const double beside = std::max(0.0, std::abs(in_door.x()) - 0.5 * door.width);
  return std::hypot(beside, in_door.y());
}

}  // namespace

std::string Blockage::sentence() const {
  return fmt::format("{} at ({:.1f}, {:.1f}) is blocked, {:.1f} m free, need {:.1f} m", is_door ? "door" : "way",
                     place.x(), place.y(), free_width, need);
}

Blockage measure_blockage(const ConfigurationSpace& space, const std::vector<Door>& doors, const Polyline& path,
                          std::size_t index, double need) {
  Blockage blockage;
  blockage.need = need;
  index = std::min(index, path.size() - 1);
  blockage.place = path[index];
  const auto nearest = std::min_element(doors.begin(), doors.end(), [&](const Door& a, const Door& b) {
    return distance_to(a, path[index]) < distance_to(b, path[index]);
  });
  if (nearest != doors.end() && distance_to(*nearest, path[index]) <= kDoorReach) {
    const double theta = nearest->world_from_door.theta;
    blockage.is_door = true;
    blockage.place = nearest->world_from_door.position();
    // what closes it may stand a little before or behind the opening
    const Eigen::Vector2d along(std::cos(theta), std::sin(theta));
    const Eigen::Vector2d through(-along.y(), along.x());
    blockage.free_width = nearest->width;
    for (double offset = -kDoorDepth; offset <= kDoorDepth; offset += 0.5 * space.geometry().resolution) {
      blockage.free_width = std::min(blockage.free_width,
                                     widest_gap(space, blockage.place + offset * through, along, 0.5 * nearest->width));
    }
    blockage.free_width = std::min(blockage.free_width, need - 0.1);
    return blockage;
  }
  blockage.free_width = 2.0 * kCrossSection;
  for (std::size_t i = index; i < std::min(index + kLookFurther, path.size()); ++i) {
    const Eigen::Vector2d ahead = path[std::min(i + 1, path.size() - 1)] - path[i > 0 ? i - 1 : 0];
    if (ahead.norm() < 1e-6) {
      continue;
    }
    const Eigen::Vector2d across = Eigen::Vector2d(-ahead.y(), ahead.x()).normalized();
    blockage.free_width = std::min(blockage.free_width, widest_gap(space, path[i], across, kCrossSection));
  }
  blockage.free_width = std::min(blockage.free_width, need - 0.1);
  return blockage;
}

std::optional<Eigen::Vector2d> what_blocks(const ConfigurationSpace& space, const OccupancyGrid& grid,
                                           const Polyline& path, double radius) {
  const GridGeometry& geometry = space.geometry();
  const int reach = static_cast<int>(std::ceil(radius / geometry.resolution));
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Cell middle = geometry.cell_at(path[i]);
    if (!geometry.contains(middle) || !space.is_blocked(middle)) {
      continue;
    }
    std::optional<Eigen::Vector2d> nearest;
    for (int row = middle.row - reach; row <= middle.row + reach; ++row) {
      for (int column = middle.column - reach; column <= middle.column + reach; ++column) {
        const Cell cell{column, row};
        const Eigen::Vector2d place = geometry.centre_of(cell);
        if (!geometry.contains(cell) || !space.is_solid(cell) ||
            (place - geometry.centre_of(middle)).norm() > radius + 1e-6) {
          continue;
        }
        const std::size_t k = geometry.index(cell);
        const bool is_wall = grid.prior[k] == Prior::kOccupied || grid.prior[k] == Prior::kDisputed;
        if (!is_wall && grid.evidence[k] > 0 &&
            (!nearest || (place - path.front()).squaredNorm() < (*nearest - path.front()).squaredNorm())) {
          nearest = place;
        }
      }
    }
    if (nearest) {
      return nearest;
    }
  }
  return std::nullopt;
}

}  // namespace luminav
