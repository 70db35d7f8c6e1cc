#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/geometry/camera_model.hpp"

namespace luminav {

/// Where each cell of a reduced image lies on the ceiling; made once per camera.
class CellPlane {
 public:
  /// Cells are factor x factor pixels.
  CellPlane(const CeilingCamera& camera, int factor, double height);

  /// Robot frame [m]; not a number where the ray does not reach the ceiling within `kFarthest` heights.
  [[nodiscard]] Eigen::Vector2d at(int column, int row) const;
  /// What a cell covers of the ceiling.
  struct Footprint {
    double side;  // [m] at its largest
    double area;  // [m^2]
  };
  [[nodiscard]] Footprint footprint(int column, int row) const;
  [[nodiscard]] bool is_at_border(int column, int row) const {
    return column <= 0 || row <= 0 || column >= width_ - 1 || row >= height_ - 1;
  }
  [[nodiscard]] double ceiling_height() const { return ceiling_height_; }
  [[nodiscard]] Eigen::Vector2d camera_foot() const { return camera_foot_; }
  [[nodiscard]] double camera_height() const { return camera_height_; }

  static constexpr double kFarthest = 4.0;

 private:
  int width_;
  int height_;
  double ceiling_height_;
  Eigen::Vector2d camera_foot_;
  double camera_height_;
  std::vector<Eigen::Vector2f> points_;
};

}  // namespace luminav
