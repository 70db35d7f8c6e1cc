#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// A pose and how well it is known.
struct PoseBelief {
  Pose2 pose;                                                // world_from_robot
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // [m^2, m rad, rad^2] of (x, y, theta), world frame
};

/// One of the poses still held for possible.
struct WeightedPose {
  Pose2 pose;
  double weight = 0.0;          // share of the whole, 0..1
  double position_sigma = 0.0;  // [m]
};

enum class LocalizerState { kLost, kAmbiguous, kTracking };
enum class EstimatorKind { kNone, kParticleFilter, kKalmanFilter, kHypotheses };

/// What the localizer believes and why.
struct LocalizerEstimate {
  LocalizerState state = LocalizerState::kLost;
  EstimatorKind estimator = EstimatorKind::kNone;
  std::string reason;
  PoseBelief belief;                    // best guess unless TRACKING
  std::int64_t fixture_utime = 0;       // [us] of the last image whose sightings were used
  double distance_since_fixture = 0.0;  // [m]
  std::optional<double> nis;            // normalised innovation squared per degree of freedom, running mean
};

/// Square root of the mean position variance [m].
inline double position_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, 0.5 * (covariance(0, 0) + covariance(1, 1))));
}

/// Position sigma [m] with a share of what the variance along the longer axis exceeds the mean by: 1 = that axis alone.
inline double position_sigma_towards_longest(const Eigen::Matrix3d& covariance, double share) {
  const double mean = 0.5 * (covariance(0, 0) + covariance(1, 1));
  const double excess = std::hypot(0.5 * (covariance(0, 0) - covariance(1, 1)), covariance(0, 1));
  return std::sqrt(std::max(0.0, mean + share * excess));
}
/// Sigma [m] along the longer axis of a position's error.
inline double largest_position_sigma(const Eigen::Matrix3d& covariance) {
  return position_sigma_towards_longest(covariance, 1.0);
}
/// Sigma [m] of the round position error of which 95 % lie within the same radius; at most 3 % too large.
inline double round_position_sigma(const Eigen::Matrix3d& covariance) {
  return position_sigma_towards_longest(covariance, 0.28);  // chi2 of one degree of freedom to that of two
}

/// A covariance that says "anywhere".
inline Eigen::Matrix3d unknown_pose_covariance() {
  return Eigen::Vector3d(1e6, 1e6, 1e2).asDiagonal();
}

}  // namespace luminav
