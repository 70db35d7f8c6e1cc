#pragma once

#include "services/common/geometry/angle.hpp"

namespace luminav {

/// When one hypothesis counts as the truth, and when no longer.
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
  int newcomer_frames = 7;                    // images of what came into view of a standing robot and fits nothing
  int vanish_frames = 7;                      // images without a fixture that was there, the robot standing still
  double still_distance = 0.02;               // [m] since the last match: the robot stands still
  double still_turn = radians(1.5);           // [rad] likewise
  double stop_distance = 0.15;                // [m] since the last match, and standing now: it has just stopped
  double stop_turn = radians(6.0);            // [rad] likewise
  int pause_frames = 10;                      // images in a row without wheel motion: the robot may have been carried
  double displacement_time = 0.6;             // [s] over which the motion of fixtures is compared with the wheels'
  double displacement = 0.15;                 // [m] beyond image noise that wheels, slipping or not, do not explain
  int displacement_frames = 3;                // images in a row that show it: somebody moves the robot
  double rush_speed = 0.4;                    // [m/s] of a thing past the robot, likewise, in two steps between images
  int miss_frames = 10;                       // images without a fixture that ought to be there
  int miss_fixtures = 2;                      // so many of them, and nothing else seen meanwhile ...
  double miss_distance = 1.5;                 // [m] ... or one of them over this way
  double visible_margin = 0.03;               // [m] from the image border, beside twice the pose's own error
  double vanish_share = 0.4;                  // of a fixture seen just before that must be in view to miss it
  double miss_share = 0.8;                    // likewise of any other fixture
  double log_prior_after_misfit = 6.0;        // prior of the old pose when what was seen did not fit it
  double log_prior_when_driving = 13.0;       // likewise when nobody can have carried the robot since its last match:
  int halt_frames = 3;                        // ... fewer images in a row than that without wheel motion since
  double match_age = 3.0;                     // [s] ... and it is not older than that
  int trusted_fixtures = 8;                   // ... and the pose predicted so many different fixtures
  double log_prior_after_miss = 10.0;         // prior of the old pose when only something was missing
  double log_prior_after_gap = 13.0;          // prior of the old pose when only odometry was away for a while
  double log_prior_when_predicted = 5.0;      // more of it once a doubted pose predicted the next fixture
  double log_prior_of_guess = 6.0;            // prior of a user's guess
  int restart_frames = 12;                    // images with sightings that no hypothesis explains: begin anew
};

}  // namespace luminav
