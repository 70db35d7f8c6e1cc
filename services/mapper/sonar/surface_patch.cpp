#include "services/mapper/sonar/surface_patch.hpp"

#include <Eigen/Core>
#include <bit>
#include <cmath>

namespace luminav {
namespace {

constexpr int kSurfaceCells = 4;          // fewer are no surface
constexpr double kSurfaceThinness = 0.2;  // ratio of variances across and along; a straight wall of one cell has 0.02

}  // namespace

void SurfacePatch::add(int columns, int rows) {
  cells_ |= std::uint64_t{1} << ((rows + kReach) * kRow + columns + kReach);
}

SurfacePatch SurfacePatch::connected_to_middle() const {
  SurfacePatch connected;
  connected.add(0, 0);
  connected.cells_ &= cells_;
  for (std::uint64_t before = 0; connected.cells_ != before;) {
    before = connected.cells_;
    connected.cells_ |= connected.cells_ << 1 | connected.cells_ >> 1;
    connected.cells_ |= connected.cells_ << kRow | connected.cells_ >> kRow;
    connected.cells_ &= cells_;
  }
  return connected;
}

std::optional<double> SurfacePatch::direction() const {
  const int count = std::popcount(cells_);
  if (count < kSurfaceCells) {
    return std::nullopt;
  }
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  double product = 0.0;
  for (std::uint64_t left = cells_; left != 0; left &= left - 1) {
    const int bit = std::countr_zero(left);
    const int columns = bit % kRow - kReach;
    const int rows = bit / kRow - kReach;
    mean += Eigen::Vector2d(columns, rows);
    squares += Eigen::Vector2d(columns * columns, rows * rows);
    product += columns * rows;
  }
  mean /= count;
  const double xx = squares.x() / count - mean.x() * mean.x();
  const double yy = squares.y() / count - mean.y() * mean.y();
  const double xy = product / count - mean.x() * mean.y();
  const double spread = std::hypot(0.5 * (xx - yy), xy);
  const double thin = 0.5 * (xx + yy) - spread;
  const double wide = 0.5 * (xx + yy) + spread;
  if (thin > kSurfaceThinness * wide) {
    return std::nullopt;
  }
  return 0.5 * std::atan2(2.0 * xy, xx - yy);
}

}  // namespace luminav
