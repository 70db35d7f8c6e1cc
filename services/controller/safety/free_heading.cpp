#include "services/controller/safety/free_heading.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav {
namespace {

constexpr double kWidest = 1.2;       // [rad] off the wish
constexpr double kStep = 0.1;         // [rad] between the headings tried
constexpr double kSteadiness = 0.25;  // [rad] a new heading must be better than the last one by this
constexpr double kPrice = 2.0;        // [rad] a metre of missing free distance counts as much as so much of a detour

}  // namespace

double free_distance(double direction, double max, std::span<const ObstaclePoint> obstacles,
                     const FreeHeadingParams& params) {
  const Eigen::Vector2d along(std::cos(direction), std::sin(direction));
  double nearest = max + params.nose;
  for (const ObstaclePoint& obstacle : obstacles) {
    const double ahead = along.dot(obstacle.position);
    const double beside = along.x() * obstacle.position.y() - along.y() * obstacle.position.x();
    if (ahead > 0.0 && ahead < nearest && std::abs(beside) < params.half_width) {
      nearest = ahead;
    }
  }
  return std::max(0.0, nearest - params.nose);
}

double choose_free_heading(double wish, double needed, std::optional<double> last,
                           std::span<const ObstaclePoint> obstacles, const FreeHeadingParams& params) {
  const auto cost_of = [&](int i) {
    const double direction = wish + i * kStep;
    const double missing = needed - free_distance(direction, needed, obstacles, params);
    const bool is_another = last && std::abs(wrap_angle(direction - *last)) > kSteadiness;
    return std::abs(i * kStep) + kPrice * missing + (is_another ? kSteadiness : 0.0);
  };
  if (cost_of(0) < kStep) {
    return wrap_angle(wish);  // any other heading is dearer
  }
  const int steps = static_cast<int>(kWidest / kStep);
  int best = 0;
  double best_cost = 1e9;
  for (int i = -steps; i <= steps; ++i) {
    const double cost = cost_of(i);
    if (cost < best_cost - 1e-9) {
      best_cost = cost;
      best = i;
    }
  }
  return wrap_angle(wish + best * kStep);
}

}  // namespace luminav
