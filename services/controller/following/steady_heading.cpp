#include "services/controller/following/steady_heading.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/geometry/angle.hpp"

namespace luminav {

double SteadyHeading::choose(double wish, double needed, double theta, double duration,
                             std::span<const ObstaclePoint> obstacles) {
  const std::optional<double> last = last_ ? std::optional(wrap_angle(*last_ - theta)) : std::nullopt;
  const double chosen = choose_free_heading(wish, needed, last, obstacles, params_.free_heading);
  last_ = wrap_angle(theta + chosen);
  const double change = smooth_ ? wrap_angle(*last_ - *smooth_) : 1e9;
  smooth_ = std::abs(change) < params_.jump
                ? wrap_angle(*smooth_ + std::min(1.0, duration / params_.smoothing) * change)
                : *last_;
  return wrap_angle(*smooth_ - theta);
}

void SteadyHeading::reset() {
  last_.reset();
  smooth_.reset();
}

}  // namespace luminav
