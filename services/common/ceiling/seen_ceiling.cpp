#include "services/common/ceiling/seen_ceiling.hpp"

#include <cmath>

namespace luminav {
namespace {

constexpr double kRadius = 1.0;  // [m] that a webcam sees around the robot, whatever its heading
constexpr double kCell = 0.25;   // [m]

std::int64_t cell_at(const Eigen::Vector2d& point) {
  constexpr std::int64_t kColumns = 1'000'000;
  return static_cast<std::int64_t>(std::floor(point.y() / kCell)) * kColumns +
         static_cast<std::int64_t>(std::floor(point.x() / kCell));
}

}  // namespace

SeenCeiling::SeenCeiling(const std::vector<Eigen::Vector2d>& places) {
  for (const Eigen::Vector2d& place : places) {
    for (double x = -kRadius; x <= kRadius; x += kCell) {
      for (double y = -kRadius; y <= kRadius; y += kCell) {
        if (std::hypot(x, y) < kRadius) {
          cells_.insert(cell_at(place + Eigen::Vector2d(x, y)));
        }
      }
    }
  }
}

bool SeenCeiling::contains(const Eigen::Vector2d& point) const {
  constexpr double kFar = 1e5;  // [m] beyond it nothing was seen
  return std::abs(point.x()) < kFar && std::abs(point.y()) < kFar && cells_.contains(cell_at(point));
}

}  // namespace luminav
