#pragma once

#include <vector>

#include "services/localizer/model/wheel_correction.hpp"
#include "services/surveyor/survey/fixture_passes.hpp"
#include "services/surveyor/survey/key_frames.hpp"

namespace luminav {

/// A first guess of the wheels' errors from how the passing fixtures turned while the wheels told another turn: one
/// linear equation for each pass. It keeps the path that the survey begins with from curling up. `known` is what the
/// robot's file says, and holds where the passes say nothing. Scale and base turn the robot alike: the base takes it.
WheelCorrection guess_wheels(const std::vector<KeyFrame>& frames, const std::vector<FixturePass>& passes,
                             double wheel_base, const WheelCorrection& known);

/// world_from_robot of each key frame by odometry alone, the first of each part at the origin.
std::vector<Pose2> dead_reckoning(const std::vector<KeyFrame>& frames, double wheel_base,
                                  const WheelCorrection& wheels);

}  // namespace luminav
