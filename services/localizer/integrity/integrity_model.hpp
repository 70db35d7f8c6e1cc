#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>

#include "services/common/geometry/angle.hpp"

// Is the robot where it is held to be? All that decides it stands here as logs of likelihood ratios.
//
// Each image adds evidence that it is elsewhere; one that shows a fixture where the pose has it ends the sum (Page
// 1954). At `doubt` the pose becomes one hypothesis among others again, with the log-prior of what spoke against it.
// The hypotheses' scores then decide: who leads all others, listed or not, by a margin is the truth.
//
//   phase       ends, and what follows
//   searching   a hypothesis leads by `first_margin` (`enter_margin` once a pose was held for true): following
//   following   evidence reaches `doubt`, odometry is lost, or a hand moves the robot: doubted; another pose comes as
//               near as `leave_margin`: searching; no fixture for long, or not known well: blind. What is seen beside
//               the place of its like hangs there, or the robot slipped or was bumped: the filter becomes that of both,
//               and the pose is doubted only if that is far or somebody may have carried the robot
//   blind       the next fixture that fits: following
//   doubted     it leads by `enter_margin`: following, and the map is doubted; others are far ahead: searching
//   displaced   the robot is at rest: doubted if it was followed by sight meanwhile, else searching, all forgotten
namespace luminav {

/// Log-priors of poses that somebody says, or that were held for true until something contradicted them.
namespace log_prior {
inline constexpr double kAfterMisfit = 6.0;    // of the old pose: what was seen did not fit it
inline constexpr double kAfterMiss = 10.0;     // likewise, and only something was missing
inline constexpr double kAfterGap = 13.0;      // likewise, and only odometry was away for a while
inline constexpr double kWhenPredicted = 5.0;  // more of it once a suspected pose predicted the next fixture
inline constexpr double kOfGuess = 6.0;        // of what a user says
}  // namespace log_prior

/// What one image says against the pose. Images come 15 a second and share their errors: each counts for little.
namespace log_evidence {
inline constexpr double kMisfit = 2.0;     // something is seen that no fixture explains
inline constexpr double kCalm = -0.2;      // of such things before: nothing strange is seen
inline constexpr double kVanished = 1.5;   // a fixture that was seen from here is not
inline constexpr double kCarried = 2.0;    // one is missing since the robot may have been carried
inline constexpr double kMissed = 0.5;     // one is missing: the detector overlooks it from some places ...
inline constexpr double kMaxMissed = 5.0;  // ... perhaps all the while the robot passes
}  // namespace log_evidence

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
  double enter_heading_sigma = radians(6.0);  // [rad]
  double leave_position_sigma = 0.2;          // [m] of a round error: beyond, less than 95 % lie within 0.5 m
  double leave_heading_sigma = radians(9.0);  // [rad]
  double doubt = 10.0;                        // log-evidence of the images since the last match that suspects the pose
};

/// What speaks against a tracked pose.
struct Contradiction {
  std::string reason;
  double log_prior = 0.0;                   // that the old pose keeps nevertheless
  bool may_predict = false;                 // a fixture where the old pose has one speaks for it
  int needed_fixtures = 1;                  // that the old pose must fit before it is held for true again
  std::optional<Eigen::Vector2d> misfit{};  // [world] where something is seen that is no fixture
  int missed_fixture = -1;                  // that ought to be in view and is not seen
};

}  // namespace luminav
