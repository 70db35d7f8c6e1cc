#include "services/controller/way_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luminav {

WayLattice::WayLattice(const Eigen::Vector2d& place, double reach, double step) : step_(step) {
  const int half = static_cast<int>(reach / step);
  columns_ = 2 * half + 1;
  start_ = half * columns_ + half;
  corner_ = (place / step).array().round().matrix() * step - Eigen::Vector2d::Constant(half * step);
  const auto count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(columns_);
  way_.assign(count, std::numeric_limits<double>::infinity());
  price_.assign(count, -1.0);
  from_.assign(count, -1);
  way_[static_cast<std::size_t>(start_)] = 0.0;
  open_.push({start_, 0.0});
}

std::optional<WayLattice::Visit> WayLattice::next() {
  while (!open_.empty()) {
    const Visit visit = open_.top();
    open_.pop();
    if (visit.way <= way_[static_cast<std::size_t>(visit.node)]) {
      return visit;
    }
  }
  return std::nullopt;
}

void WayLattice::expand(const Visit& visit, const std::function<double(const Eigen::Vector2d&)>& price) {
  const int column = visit.node % columns_;
  const int row = visit.node / columns_;
  if (column == 0 || row == 0 || column == columns_ - 1 || row == columns_ - 1) {
    return;
  }
  for (const int step : {1, -1, columns_, -columns_, columns_ + 1, columns_ - 1, -columns_ + 1, -columns_ - 1}) {
    const auto next = static_cast<std::size_t>(visit.node + step);
    const double length = step_ * (std::abs(step) == 1 || std::abs(step) == columns_ ? 1.0 : std::sqrt(2.0));
    if (visit.way + length >= way_[next]) {
      continue;  // whatever it costs
    }
    if (price_[next] < 0.0) {
      price_[next] = price(place_of(visit.node + step));
    }
    const double way = visit.way + length * price_[next];
    if (way < way_[next]) {
      way_[next] = way;
      from_[next] = visit.node;
      open_.push({visit.node + step, way});
    }
  }
}

Eigen::Vector2d WayLattice::place_of(int node) const {
  return corner_ + step_ * Eigen::Vector2d(node % columns_, node / columns_);
}

std::vector<Eigen::Vector2d> WayLattice::way_to(int node) const {
  std::vector<Eigen::Vector2d> way;
  for (; node != start_; node = from_[static_cast<std::size_t>(node)]) {
    way.push_back(place_of(node));
  }
  std::reverse(way.begin(), way.end());
  return way;
}

}  // namespace luminav
