#pragma once

#include "services/common/geometry/angle.hpp"

namespace luminav {

/// Log-priors of poses that somebody says, or that were held for true until something contradicted them.
namespace log_prior {
inline constexpr double kAfterMisfit = 6.0;    // of the old pose: what was seen did not fit it
inline constexpr double kWhenDriving = 13.0;   // likewise, and nobody can have carried the robot since its last match
inline constexpr double kAfterMiss = 10.0;     // likewise, and only something was missing
inline constexpr double kAfterGap = 13.0;      // likewise, and only odometry was away for a while
inline constexpr double kWhenPredicted = 5.0;  // more of it once a suspected pose predicted the next fixture
inline constexpr double kOfGuess = 6.0;        // of what a user says
}  // namespace log_prior

/// When one hypothesis counts as the truth, and when no longer: what a robot's file may set.
struct TrackingRules {
  // Log-score ahead of every other pose, listed or not, at first: neither a wall that is not heard nor one misfit may
  // decide alone.
  double first_margin = 6.6;
  double enter_margin = 9.0;                  // likewise once a pose was held for true: it may have been wrong
  double min_without_sonar = -3.0;            // of these margins: how far the ceiling may speak against the pose
  double leave_margin = 3.0;                  // below this another pose is possible again
  int enter_fixtures = 2;                     // different fixtures that must have fitted
  double enter_position_sigma = 0.14;         // [m] largest axis
  double leave_position_sigma = 0.16;         // [m] largest axis: beyond, 0.5 m are no longer two deviations away
  double leave_heading_sigma = radians(9.0);  // [rad]
  int misfit_frames = 5;                      // images that show what fits nothing; after a pause, that contradict
  int vanish_frames = 7;                      // images without a fixture that was there, the robot standing still
  int pause_frames = 10;                      // images in a row without wheel motion: the robot may have been carried
  double displacement = 0.15;                 // [m] beyond image noise that wheels, slipping or not, do not explain
  int miss_frames = 10;                       // images without a fixture that ought to be there
  int miss_fixtures = 2;                      // so many of them, and nothing else seen meanwhile ...
  double miss_distance = 1.5;                 // [m] ... or one of them over this way
};

}  // namespace luminav
