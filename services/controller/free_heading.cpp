#include "services/controller/free_heading.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

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
  const auto cost_of = [&](int i, double missing) {
    const double direction = wish + i * params.step;
    const bool is_another = last && std::abs(wrap_angle(direction - *last)) > params.steadiness;
    return std::abs(i * params.step) + params.price * missing + (is_another ? params.steadiness : 0.0);
  };
  const double cost_of_wish = cost_of(0, needed - free_way(wish, needed, obstacles, params));
  if (cost_of_wish + 1e-9 < params.step && params.steadiness >= 0.0) {
    return wrap_angle(wish);  // the next one beside it is dearer even when it is free
  }
  // what is farther off shortens no way of the length needed, whatever the direction
  const double ahead = std::max(0.0, needed + params.nose);
  const double reach_squared = 1.000001 * (ahead * ahead + params.half_width * params.half_width);
  std::vector<ObstaclePoint> near;
  std::copy_if(obstacles.begin(), obstacles.end(), std::back_inserter(near),
               [&](const ObstaclePoint& obstacle) { return obstacle.position.squaredNorm() < reach_squared; });
  const auto cost_at = [&](int i) {
    return cost_of(i, needed - free_way(wish + i * params.step, needed, near, params));
  };
  const int steps = static_cast<int>(params.widest / params.step);
  // a heading that is dearer than the wish even when it is free need not be looked at: mostly that is nearly all
  double best = wish;
  double best_cost = 1e9;
  for (int i = -steps; i <= steps; ++i) {
    if (i != 0 && cost_of(i, 0.0) > cost_of_wish + 1e-9) {
      continue;
    }
    const double cost = i == 0 ? cost_of_wish : cost_at(i);
    const double direction = wish + i * params.step;
    if (cost < best_cost - 1e-9) {
      best_cost = cost;
      best = direction;
    }
  }
  return wrap_angle(best);
}

}  // namespace luminav
