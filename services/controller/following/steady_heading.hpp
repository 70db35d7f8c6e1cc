#pragma once

#include <optional>

#include "services/common/geometry/angle.hpp"
#include "services/controller/safety/free_heading.hpp"

namespace luminav {

struct SteadyHeadingParams {
  FreeHeadingParams free_heading;
  double smoothing = 0.2;       // [s] time constant of small changes, ...
  double jump = radians(20.0);  // [rad] ... up to here; what is more follows at once
};

/// The free heading chosen from step to step: it keeps to the last choice, and follows small changes slowly. Between
/// door posts each echo shifts the choice by a degree or two; steering after all of them is jitter.
class SteadyHeading {
 public:
  explicit SteadyHeading(const SteadyHeadingParams& params) : params_(params) {}

  /// Heading to steer [rad, robot frame]. `theta` is the robot's heading [rad] in any frame that does not turn with it,
  /// the same from step to step; `duration` [s] since the last step.
  double choose(double wish, double needed, double theta, double duration, std::span<const ObstaclePoint> obstacles);
  void reset();

 private:
  SteadyHeadingParams params_;
  std::optional<double> last_;    // [rad] in the frame of theta, as chosen
  std::optional<double> smooth_;  // [rad] the same without its jitter
};

}  // namespace luminav
