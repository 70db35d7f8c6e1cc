#include "services/controller/safety/free_heading.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav {

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
    const double direction = wish + i * params.step;
    const double missing = needed - free_distance(direction, needed, obstacles, params);
    const bool is_another = last && std::abs(wrap_angle(direction - *last)) > params.steadiness;
    return std::abs(i * params.step) + params.price * missing + (is_another ? params.steadiness : 0.0);
  };
  const int steps = static_cast<int>(params.widest / params.step);
  int best = 0;
  double best_cost = 1e9;
  for (int i = -steps; i <= steps; ++i) {
    const double cost = cost_of(i);
    if (cost < best_cost - 1e-9) {
      best_cost = cost;
      best = i;
    }
  }
  return wrap_angle(wish + best * params.step);
}

}  // namespace luminav
