#include "services/controller/following/lookahead.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luminav {
namespace {

constexpr double kShortening = 0.1;  // [m] per step, one cell

// The point of the path at an arc length [m]; its ends beyond them.
Eigen::Vector2d point_at(const MeasuredPath& path, double length) {
  const std::vector<Eigen::Vector2d>& points = path.points;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double segment = path.segments[i];
    if (length <= segment) {
      const Eigen::Vector2d step = points[i + 1] - points[i];
      return segment > 0.0 ? Eigen::Vector2d(points[i] + step * (std::max(0.0, length) / segment)) : points[i];
    }
    length -= segment;
  }
  return points.back();
}

}  // namespace

MeasuredPath::MeasuredPath(const std::vector<Eigen::Vector2d>& path) : points(path) {
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    segments.push_back((points[i + 1] - points[i]).norm());
    length += segments.back();
  }
}

LookAhead find_look_ahead(const MeasuredPath& path, double travelled, const Eigen::Vector2d& position,
                          const LookAheadParams& params, const LineTest& is_line_free) {
  const std::vector<Eigen::Vector2d>& points = path.points;
  LookAhead result;
  double nearest = std::numeric_limits<double>::infinity();
  double start = 0.0;  // [m] of the segment along the path
  for (std::size_t i = 0; i < path.segments.size() && start <= travelled + params.search_window; ++i) {
    const double segment = path.segments[i];
    if (start + segment >= travelled && segment > 0.0) {
      const Eigen::Vector2d step = points[i + 1] - points[i];
      const double min = std::max(0.0, travelled - start);
      const double along = std::clamp(step.dot(position - points[i]) / segment, min, segment);
      const double apart = (points[i] + step * (along / segment) - position).norm();
      if (apart < nearest) {
        nearest = apart;
        result.travelled = start + along;
      }
    }
    start += segment;
  }
  const double length = path.length;
  if (!std::isfinite(nearest)) {
    result.travelled = length;
    nearest = (points.back() - position).norm();
  }
  result.off_path = nearest;
  const double along_path = length - result.travelled;
  result.distance_left = std::max((points.back() - position).norm(), along_path);
  double ahead = params.distance;
  result.point = point_at(path, result.travelled + ahead);
  while (ahead > params.min + 1e-9 && !is_line_free(position, result.point)) {
    ahead = std::max(params.min, ahead - kShortening);
    result.point = point_at(path, result.travelled + ahead);
  }
  return result;
}

}  // namespace luminav
