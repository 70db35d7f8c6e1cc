#include "tests/unit/recorded_ceiling/light_grid.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include "services/common/geometry/angle.hpp"

namespace luminav::testing {
namespace {

constexpr double kInLine = 0.5;  // [m] beside the row of a neighbour

double mean_heading(const std::vector<Pose2>& bars) {
  std::complex<double> sum = 0.0;
  for (const Pose2& bar : bars) {
    sum += std::polar(1.0, 2.0 * bar.theta);
  }
  return 0.5 * std::arg(sum);
}

/// Median distance [m] along an axis to the nearest one in line.
double spacing(const Eigen::Matrix2Xd& places, int axis) {
  std::vector<double> nearest;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index k = 0; k < places.cols(); ++k) {
      const Eigen::Vector2d apart = (places.col(k) - places.col(i)).cwiseAbs();
      least = k != i && apart(1 - axis) < kInLine ? std::min(least, apart(axis)) : least;
    }
    if (std::isfinite(least)) {
      nearest.push_back(least);
    }
  }
  if (nearest.empty()) {
    throw std::runtime_error("no grid: no two fixtures hang in line");
  }
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

}  // namespace

LightGrid fit_light_grid(const std::vector<Pose2>& bars) {
  const double heading = mean_heading(bars);
  const Pose2 world_from_rows{0.0, 0.0, heading - 0.5 * kPi};  // y along the bars
  Eigen::Matrix2Xd places(2, static_cast<Eigen::Index>(bars.size()));
  for (std::size_t i = 0; i < bars.size(); ++i) {
    places.col(static_cast<Eigen::Index>(i)) = world_from_rows.inverse() * Eigen::Vector2d(bars[i].position());
  }
  const Eigen::Vector2d rough(spacing(places, 0), spacing(places, 1));
  Eigen::MatrixX3d crossings(places.cols(), 3);
  std::set<std::pair<double, double>> distinct;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const Eigen::Array2d steps = (places.col(i) - places.col(0)).cwiseQuotient(rough).array().round();
    crossings.row(i) << steps.x(), steps.y(), 1.0;
    distinct.emplace(steps.x(), steps.y());
  }
  const Eigen::MatrixX2d fit = crossings.colPivHouseholderQr().solve(Eigen::MatrixX2d(places.transpose()));
  const Eigen::RowVector2d across = fit.row(0);
  const Eigen::RowVector2d along = fit.row(1);
  const double along_heading = std::atan2(along.y(), along.x());
  LightGrid grid;
  grid.pitch = {across.norm(), along.norm()};
  grid.angle = wrap_angle(along_heading - std::atan2(across.y(), across.x()));
  grid.turn = wrap_modulo(0.5 * kPi - along_heading, kPi);
  const auto count = static_cast<double>(bars.size());
  grid.spread = (places.transpose() - crossings * fit).norm() / std::sqrt(count);
  for (const Pose2& bar : bars) {
    grid.turn_spread += std::pow(wrap_modulo(bar.theta - heading, kPi), 2) / count;
  }
  grid.turn_spread = std::sqrt(grid.turn_spread);
  grid.crossings = distinct.size();
  return grid;
}

}  // namespace luminav::testing
