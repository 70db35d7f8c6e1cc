#include "drivers/camera/simulated/rays.hpp"

#include <algorithm>
#include <cmath>

namespace luminav::simulated {
namespace {

constexpr double kMinRise = 0.12;  // cosine to the zenith, 83 degrees: flatter rays end at a wall, not at the ceiling

}  // namespace

RayTable::RayTable(const CeilingCamera& camera)
    : width_(camera.intrinsics().width), height_(camera.intrinsics().height) {
  const std::size_t pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  x_.reserve(pixels);
  y_.reserve(pixels);
  std::vector<float> below(pixels, 0.0F);
  bool any_below = false;
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      // what the lens does not show is as dark as what lies below
      const Eigen::Vector3d nowhere(0.0, 0.0, -1.0);
      const Eigen::Vector3d ray = camera.rotation() * camera.ray_in_camera({column, row}).value_or(nowhere);
      const double rise = std::max(ray.z(), kMinRise);
      if (ray.z() < kMinRise) {
        below[x_.size()] = 1.0F;
        any_below = true;
      }
      x_.push_back(static_cast<float>(ray.x() / rise));
      y_.push_back(static_cast<float>(ray.y() / rise));
      reach_ = std::max(reach_, std::hypot(ray.x(), ray.y()) / rise);
    }
  }
  if (any_below) {
    below_ = std::move(below);
  }
}

}  // namespace luminav::simulated
