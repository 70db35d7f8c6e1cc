#include "services/controller/following/lookahead.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luminav {
namespace {

constexpr double kShortening = 0.1;  // [m] per step, one cell

// The point of the path at an arc length [m]; its ends beyond them.
Eigen::Vector2d point_at(const std::vector<Eigen::Vector2d>& path, double length) {
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Eigen::Vector2d step = path[i + 1] - path[i];
    const double segment = step.norm();
    if (length <= segment) {
      return segment > 0.0 ? Eigen::Vector2d(path[i] + step * (std::max(0.0, length) / segment)) : path[i];
    }
    length -= segment;
  }
  return path.back();
}

}  // namespace

LookAhead find_look_ahead(const std::vector<Eigen::Vector2d>& path, double travelled, const Eigen::Vector2d& position,
                          const LookAheadParams& params, const LineTest& is_line_free) {
  LookAhead result;
  double nearest = std::numeric_limits<double>::infinity();
  double length = 0.0;  // [m] of the path so far
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Eigen::Vector2d step = path[i + 1] - path[i];
    const double segment = step.norm();
    if (length <= travelled + params.search_window && length + segment >= travelled && segment > 0.0) {
      const double min = std::max(0.0, travelled - length);
      const double along = std::clamp(step.dot(position - path[i]) / segment, min, segment);
      const double apart = (path[i] + step * (along / segment) - position).norm();
      if (apart < nearest) {
        nearest = apart;
        result.travelled = length + along;
      }
    }
    length += segment;
  }
  if (!std::isfinite(nearest)) {
    result.travelled = length;
  }
  result.distance_left = std::max((path.back() - position).norm(), length - result.travelled);
  double ahead = params.distance;
  result.point = point_at(path, result.travelled + ahead);
  while (ahead > params.min + 1e-9 && !is_line_free(position, result.point)) {
    ahead = std::max(params.min, ahead - kShortening);
    result.point = point_at(path, result.travelled + ahead);
  }
  return result;
}

}  // namespace luminav
