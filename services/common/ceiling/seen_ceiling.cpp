#include "services/common/ceiling/seen_ceiling.hpp"

#include <algorithm>

namespace luminav {
namespace {

constexpr double kRadius = 1.0;  // [m] that a webcam sees around the robot, whatever its heading
constexpr double kCell = 0.25;   // [m]
constexpr int kReach = 4;        // [cells] of the radius

}  // namespace

SeenCeiling::SeenCeiling(const std::vector<Eigen::Vector2d>& places) {
  if (places.empty()) {
    return;
  }
  Eigen::Vector2d min = places.front();
  Eigen::Vector2d max = places.front();
  for (const Eigen::Vector2d& place : places) {
    min = min.cwiseMin(place);
    max = max.cwiseMax(place);
  }
  origin_ = min.array() - kRadius;
  columns_ = static_cast<int>((max.x() - origin_.x() + kRadius) / kCell) + 1;
  rows_ = static_cast<int>((max.y() - origin_.y() + kRadius) / kCell) + 1;
  cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (const Eigen::Vector2d& place : places) {
    const Eigen::Vector2i centre = ((place - origin_) / kCell).cast<int>();
    for (int row = std::max(0, centre.y() - kReach); row <= std::min(rows_ - 1, centre.y() + kReach); ++row) {
      for (int column = std::max(0, centre.x() - kReach); column <= std::min(columns_ - 1, centre.x() + kReach);
           ++column) {
        const Eigen::Vector2d middle = origin_ + kCell * Eigen::Vector2d(column + 0.5, row + 0.5);
        if ((middle - place).norm() < kRadius) {
          cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                 static_cast<std::size_t>(column)] = true;
        }
      }
    }
  }
}

bool SeenCeiling::contains(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d cell = (point - origin_) / kCell;
  if (!(cell.x() >= 0.0 && cell.y() >= 0.0 && cell.x() < columns_ && cell.y() < rows_)) {
    return false;
  }
  return cells_[static_cast<std::size_t>(cell.y()) * static_cast<std::size_t>(columns_) +
                static_cast<std::size_t>(cell.x())];
}

}  // namespace luminav
