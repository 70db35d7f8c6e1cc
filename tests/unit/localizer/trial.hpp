#pragma once

#include <string>
#include <vector>

#include "services/localizer/model/localizer.hpp"
#include "tests/unit/localizer/synthetic_world.hpp"

namespace luminav::testing {

struct TrialPlan {
  double duration = 120.0;        // [s]
  std::vector<double> kidnaps{};  // [s] when the robot is put somewhere else
  double grace = 1.0;             // [s] after the first image that contradicts, during which an error is forgiven
  bool whole_only = false;        // fixtures that the image cuts are not sighted, as by the paper's detector
  bool trace = false;             // print changes of state
};

/// How long the localizer worked on images, by thread CPU time.
struct StepTimes {
  double sum = 0.0;    // [s]
  double worst = 0.0;  // [s]
  long count = 0;

  void add(const StepTimes& other);
};

/// What became of one drive.
struct TrialResult {
  bool localized = false;      // TRACKING at least once
  bool correct_first = false;  // error below 0.25 m and 10 degrees when first declared
  bool tracking_at_end = false;
  double localized_after = 0.0;           // [m]
  bool resolvable = false;                // the drive up to there tells the pose to who sees and knows everything
  double resolvable_after = 0.0;          // [m]
  double localized_time = 0.0;            // [s]
  double confident_wrong = 0.0;           // [s] TRACKING with more than 0.5 m or 20 degrees of error
  double tracking = 0.0;                  // [s]
  double after_first = 0.0;               // [s] since first localized, the time after carries left out
  int recovered = 0;                      // carries after which it was TRACKING correctly again
  std::vector<double> recovery_distance;  // [m] driven until then
  double position_square = 0.0;           // sums over TRACKING with a fixture in view
  double heading_square = 0.0;
  long in_view = 0;
  double nees = 0.0;          // sum over TRACKING
  double nees_forward = 0.0;  // likewise, per axis of the robot
  double nees_left = 0.0;
  double nees_heading = 0.0;
  StepTimes search_steps;    // images used by the particle filter or the bank of hypotheses
  StepTimes tracking_steps;  // by the Kalman filter
  std::vector<double> position_errors;
  std::vector<double> heading_errors;
};

TrialResult run_trial(SyntheticWorld& world, Localizer& localizer, const TrialPlan& plan);

}  // namespace luminav::testing
