#pragma once

#include "services/localizer/model/frame_queue.hpp"
#include "services/localizer/model/observation_model.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/paper/pose_confidence.hpp"

namespace luminav {

/// When a fixture explains a sighting, and when it had to be sighted.
struct MatchLimits {
  double gate = 11.34;        // of the normalised innovation squared: chi2(3) at 99 %
  double view_margin = 0.15;  // [m] to the image's border
};

/// The building as the camera should see it from a pose: which fixture explains a sighting, how sure that is, and how a
/// whole image fits.
class SightingMatcher {
 public:
  /// The model must outlive this.
  SightingMatcher(const ObservationModel& model, const MatchLimits& limits) : model_(model), limits_(limits) {}

  /// Index of the fixture that explains a sighting best within the gate; -1: none.
  [[nodiscard]] int match(const PoseBelief& belief, const FixtureSighting& sighting,
                          const OdometryReading& odometry) const;
  /// Covariance of the sighting if it is of that fixture, robot frame.
  [[nodiscard]] Eigen::Matrix3d noise_of(const FixtureSighting& sighting, const Fixture& fixture,
                                         const OdometryReading& odometry) const;
  [[nodiscard]] ViewEvidence compare(const PoseBelief& belief, const FrameQueue::TimedFrame& timed) const;

 private:
  const ObservationModel& model_;
  MatchLimits limits_;
};

}  // namespace luminav
