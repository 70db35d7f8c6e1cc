#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>

#include "drivers/simulator/geometry/random_stream.hpp"
#include "services/common/building/occupancy_grid.hpp"

namespace luminav {

/// A floor that is nowhere quite level: at each knot of a 1 m lattice the tilt is drawn, between the knots it is
/// blended so that its deviation stays the same everywhere.
class Floor {
 public:
  /// `tilt` [rad] is 1 sigma per axis.
  Floor(double tilt, std::uint64_t seed) : tilt_(tilt), seed_(seed) {}

  /// Tilt about the world's x and y [rad].
  Eigen::Vector2d tilt_at(const Eigen::Vector2d& point) {
    const Cell knot{static_cast<int>(std::floor(point.x())), static_cast<int>(std::floor(point.y()))};
    if (!has_corners_ || !(knot == knot_)) {
      for (int i = 0; i < 4; ++i) {
        corners_[static_cast<std::size_t>(i)] = draw({knot.column + i % 2, knot.row + i / 2});
      }
      knot_ = knot;
      has_corners_ = true;
    }
    const double u = point.x() - knot.column;
    const double v = point.y() - knot.row;
    const std::array<double, 4> weights{(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v};
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double squares = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      sum += weights[i] * corners_[i];
      squares += weights[i] * weights[i];
    }
    return sum / std::sqrt(squares);
  }

 private:
  [[nodiscard]] Eigen::Vector2d draw(const Cell& knot) const {
    const std::uint64_t index = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(knot.column)) << 32) |
                                static_cast<std::uint32_t>(knot.row);
    RandomStream random(seed_, "floor", index);
    const double about_x = random.gaussian(tilt_);
    return {about_x, random.gaussian(tilt_)};
  }

  double tilt_;
  std::uint64_t seed_;
  bool has_corners_ = false;
  Cell knot_;
  std::array<Eigen::Vector2d, 4> corners_;
};

}  // namespace luminav
