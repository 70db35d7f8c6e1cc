#include "services/detector/hypotheses/cell_plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luminav {

using Eigen::Vector2d;

CellPlane::CellPlane(const CeilingCamera& camera, int factor, double height)
    : width_(camera.intrinsics().width / factor),
      height_(camera.intrinsics().height / factor),
      ceiling_height_(height),
      camera_foot_(camera.mounting().x, camera.mounting().y),
      camera_height_(camera.mounting().z) {
  points_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  const double farthest = kFarthest * (height - camera_height_);
  const float nothing = std::numeric_limits<float>::quiet_NaN();
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      const Vector2d pixel(factor * (column + 0.5) - 0.5, factor * (row + 0.5) - 0.5);
      const auto point = camera.point_on_ceiling(pixel, height);
      const bool near = point && (*point - camera_foot_).norm() < farthest;
      points_.emplace_back(near ? point->cast<float>() : Eigen::Vector2f(nothing, nothing));
    }
  }
}

Vector2d CellPlane::at(int column, int row) const {
  return points_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column)]
      .cast<double>();
}

CellPlane::Footprint CellPlane::footprint(int column, int row) const {
  const int x = std::clamp(column, 0, width_ - 2);
  const int y = std::clamp(row, 0, height_ - 2);
  const Vector2d right = at(x + 1, y) - at(x, y);
  const Vector2d down = at(x, y + 1) - at(x, y);
  return {std::max(right.norm(), down.norm()), std::abs(right.x() * down.y() - right.y() * down.x())};
}

}  // namespace luminav
