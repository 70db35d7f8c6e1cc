#pragma once

#include <optional>
#include <span>

#include "services/controller/safety/obstacles.hpp"

namespace luminav {

struct FreeHeadingParams {
  double half_width = 0.27;  // [m] of the strip that must be free: outline and margin
  double nose = 0.21;        // [m] from the wheel axis to the front
};

/// Distance [m] over which the robot's strip is free in a direction [rad, robot frame], at most `max`.
double free_distance(double direction, double max, std::span<const ObstaclePoint> obstacles,
                     const FreeHeadingParams& params);

/// The heading [rad, robot frame] nearest to the wish along which the strip is free for `needed` metres; where no
/// heading is, the best compromise. `last` is the heading chosen before, in today's robot frame: keeping to it avoids
/// dithering between two ways round.
double choose_free_heading(double wish, double needed, std::optional<double> last,
                           std::span<const ObstaclePoint> obstacles, const FreeHeadingParams& params);

}  // namespace luminav
