#include "services/controller/free_heading.hpp"

#include <algorithm>
#include <cmath>

namespace luminav {

double free_way(double direction, double most, std::span<const ObstaclePoint> obstacles,
                const FreeHeadingParams& params) {
  const double c = std::cos(direction);
  const double s = std::sin(direction);
  double way = most;
  for (const ObstaclePoint& obstacle : obstacles) {
    const double ahead = c * obstacle.position.x() + s * obstacle.position.y();
    const double beside = -s * obstacle.position.x() + c * obstacle.position.y();
    if (ahead > 0.0 && std::abs(beside) < params.half_width) {
      way = std::min(way, ahead - params.nose);
    }
  }
  return std::max(0.0, way);
}

double choose_free_heading(double wish, double needed, std::optional<double> last,
                           std::span<const ObstaclePoint> obstacles, const FreeHeadingParams& params) {
  const int steps = static_cast<int>(params.widest / params.step);
  double best = wish;
  double best_cost = 1e9;
  for (int i = -steps; i <= steps; ++i) {
    const double direction = wish + i * params.step;
    const double missing = needed - free_way(direction, needed, obstacles, params);
    double cost = std::abs(i * params.step) + params.price * missing;
    if (last && std::abs(wrap_angle(direction - *last)) > params.steadiness) {
      cost += params.steadiness;
    }
    if (cost < best_cost - 1e-9) {
      best_cost = cost;
      best = direction;
    }
  }
  return wrap_angle(best);
}

}  // namespace luminav
