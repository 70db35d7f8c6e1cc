#include "services/controller/search/path_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luminav {

PathLattice::PathLattice(const Eigen::Vector2d& place, double reach, double step) : step_(step) {
  const int half = static_cast<int>(reach / step);
  columns_ = 2 * half + 1;
  start_ = half * columns_ + half;
  corner_ = (place / step).array().round().matrix() * step - Eigen::Vector2d::Constant(half * step);
  const auto count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(columns_);
  distance_.assign(count, std::numeric_limits<double>::infinity());
  price_.assign(count, -1.0);
  from_.assign(count, -1);
  distance_[static_cast<std::size_t>(start_)] = 0.0;
  open_.push({start_, 0.0});
}

std::optional<PathLattice::Visit> PathLattice::next() {
  while (!open_.empty()) {
    const Visit visit = open_.top();
    open_.pop();
    if (visit.distance <= distance_[static_cast<std::size_t>(visit.node)]) {
      return visit;
    }
  }
  return std::nullopt;
}

void PathLattice::expand(const Visit& visit, const std::function<double(const Eigen::Vector2d&)>& price) {
  const int column = visit.node % columns_;
  const int row = visit.node / columns_;
  if (column == 0 || row == 0 || column == columns_ - 1 || row == columns_ - 1) {
    return;
  }
  for (const int step : {1, -1, columns_, -columns_, columns_ + 1, columns_ - 1, -columns_ + 1, -columns_ - 1}) {
    const auto next = static_cast<std::size_t>(visit.node + step);
    const double length = step_ * (std::abs(step) == 1 || std::abs(step) == columns_ ? 1.0 : std::sqrt(2.0));
    if (visit.distance + length >= distance_[next]) {
      continue;  // whatever it costs
    }
    if (price_[next] < 0.0) {
      price_[next] = price(place_of(visit.node + step));
    }
    const double distance = visit.distance + length * price_[next];
    if (distance < distance_[next]) {
      distance_[next] = distance;
      from_[next] = visit.node;
      open_.push({visit.node + step, distance});
    }
  }
}

Eigen::Vector2d PathLattice::place_of(int node) const {
  return corner_ + step_ * Eigen::Vector2d(node % columns_, node / columns_);
}

std::vector<Eigen::Vector2d> PathLattice::path_to(int node) const {
  std::vector<Eigen::Vector2d> path;
  for (; node != start_; node = from_[static_cast<std::size_t>(node)]) {
    path.push_back(place_of(node));
  }
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace luminav
