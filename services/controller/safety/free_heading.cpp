#include "services/controller/safety/free_heading.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "services/common/geometry/angle.hpp"
#include "services/common/geometry/vector_clones.hpp"

namespace luminav {

namespace {

/// A strip to both sides of a line from the wheel axis.
struct Strip {
  double c;  // of the line's direction
  double s;
  double half_width;  // [m]
};

/// Distance [m] along the strip to the nearest point in it; infinite where there is none.
LUMINAV_VECTOR_CLONES
double nearest_in(const Strip& strip, const PlanePoints& points) {
  const std::size_t in_vectors = points.size() / kLanes * kLanes;
  const Doubles kNone = Doubles{} + std::numeric_limits<double>::infinity();
  Doubles nearest = kNone;
  for (std::size_t i = 0; i < in_vectors; i += kLanes) {
    Doubles x;
    Doubles y;
    load(points.x() + i, x);
    load(points.y() + i, y);
    const Doubles ahead = strip.c * x + strip.s * y;
    const Doubles beside = -strip.s * x + strip.c * y;
    const auto is_in = (ahead > 0.0) & (beside < strip.half_width) & (beside > -strip.half_width);
    const Doubles distance = is_in ? ahead : kNone;
    nearest = distance < nearest ? distance : nearest;
  }
  double min = std::min(std::min(nearest[0], nearest[1]), std::min(nearest[2], nearest[3]));
  for (std::size_t i = in_vectors; i < points.size(); ++i) {
    const double ahead = strip.c * points.x()[i] + strip.s * points.y()[i];
    const double beside = -strip.s * points.x()[i] + strip.c * points.y()[i];
    min = ahead > 0.0 && std::abs(beside) < strip.half_width ? std::min(min, ahead) : min;
  }
  return min;
}

}  // namespace

double free_distance(double direction, double max, const PlanePoints& obstacles, const FreeHeadingParams& params) {
  const Strip strip{std::cos(direction), std::sin(direction), params.half_width};
  return std::max(0.0, std::min(max, nearest_in(strip, obstacles) - params.nose));
}

double choose_free_heading(double wish, double needed, std::optional<double> last, const PlanePoints& obstacles,
                           const FreeHeadingParams& params) {
  const auto cost_of = [&](int i, double missing) {
    const double direction = wish + i * params.step;
    const bool is_another = last && std::abs(wrap_angle(direction - *last)) > params.steadiness;
    return std::abs(i * params.step) + params.price * missing + (is_another ? params.steadiness : 0.0);
  };
  const double cost_of_wish = cost_of(0, needed - free_distance(wish, needed, obstacles, params));
  if (cost_of_wish + 1e-9 < params.step && params.steadiness >= 0.0) {
    return wrap_angle(wish);  // the next one beside it is dearer even when it is free
  }
  // what is farther off shortens no way of the length needed, whatever the direction
  const double ahead = std::max(0.0, needed + params.nose);
  const double reach_squared = 1.000001 * (ahead * ahead + params.half_width * params.half_width);
  PlanePoints near;
  near.reserve(obstacles.size());
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    if (obstacles[i].squaredNorm() < reach_squared) {
      near.add(obstacles[i]);
    }
  }
  const auto cost_at = [&](int i) {
    return cost_of(i, needed - free_distance(wish + i * params.step, needed, near, params));
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
