#pragma once

#include <span>
#include <vector>

#include "services/common/geometry/camera_model.hpp"

namespace luminav::simulated {

/// Where each pixel looks, robot frame: the ray through it passes (x, y) at unit height above the lens. Lens and
/// mounting are in the table, so a frame costs no trigonometry.
class RayTable {
 public:
  explicit RayTable(const CeilingCamera& camera);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Rays of one row of pixels.
  [[nodiscard]] std::span<const float> x(int row) const { return row_of(x_, row); }
  [[nodiscard]] std::span<const float> y(int row) const { return row_of(y_, row); }
  /// 0 where a pixel sees the ceiling, 1 where it looks too far down for that; empty when all see it.
  [[nodiscard]] std::span<const float> below(int row) const {
    return below_.empty() ? std::span<const float>{} : row_of(below_, row);
  }
  /// Largest distance [per m of rise] from the point above the lens that any pixel sees.
  [[nodiscard]] double reach() const { return reach_; }

 private:
  [[nodiscard]] std::span<const float> row_of(const std::vector<float>& table, int row) const {
    return std::span(table).subspan(static_cast<std::size_t>(row) * static_cast<std::size_t>(width_),
                                    static_cast<std::size_t>(width_));
  }
  int width_;
  int height_;
  std::vector<float> x_;
  std::vector<float> y_;
  std::vector<float> below_;
  double reach_ = 0.0;
};

}  // namespace luminav::simulated
