#include "services/planner/goals/path_progress.hpp"

#include <algorithm>

namespace luminav {
namespace {

constexpr double kSearchAhead = 3.0;  // [m] of the path

}  // namespace

std::size_t nearest_ahead(const Polyline& points, std::size_t at, const Eigen::Vector2d& position) {
  double searched = 0.0;
  std::size_t best = at;
  for (std::size_t i = at; i < points.size() && searched < kSearchAhead; ++i) {
    if ((points[i] - position).squaredNorm() < (points[best] - position).squaredNorm()) {
      best = i;
    }
    if (i + 1 < points.size()) {
      searched += (points[i + 1] - points[i]).norm();
    }
  }
  return best;
}

Polyline rest_of(const Polyline& points, std::size_t at, const Eigen::Vector2d& position) {
  Polyline left = {position};
  const std::size_t next = std::min(at + 1, points.size() - 1);
  left.insert(left.end(), points.begin() + static_cast<std::ptrdiff_t>(next), points.end());
  return left;
}

}  // namespace luminav
