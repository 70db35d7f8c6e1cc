#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/localizer/hypotheses/hypothesis.hpp"
#include "services/localizer/model/observation_model.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/model/sighting_model.hpp"

namespace luminav {

/// What one image says about one pose: which fixture each sighting is, and which fixtures should have been seen.
struct FrameComparison {
  std::vector<int> fixture_of_sighting;  // -1 = fits none
  std::vector<double> log_likelihood;    // of each sighting if the building's file lists all
  std::vector<bool> may_be_unlisted;     // it fits none, where the building's file need not list it
  std::vector<int> missed;               // fixtures well in view with nothing there
  std::vector<int> expected;             // fixtures well in view

  /// Log-likelihood of a sighting of that object.
  [[nodiscard]] double of(std::size_t sighting, const ObjectTrack& object) const {
    return may_be_unlisted[sighting] ? log_likelihood_unlisted(object) : log_likelihood[sighting];
  }
};

/// Compares one image with what poses would show there. What is the same for all poses is worked out once.
class FrameComparer {
 public:
  /// Linear [m/s] and angular [rad/s] twist of the robot at the image's time; everything given must outlive this.
  FrameComparer(const SightingFrame& frame, double linear, double angular, const ObservationModel& model,
                const HypothesisParams& params);

  [[nodiscard]] FrameComparison compare(const PoseBelief& belief) const;
  /// Covariance of a sighting taken as that fixture, whatever the pose; in the robot frame.
  [[nodiscard]] Eigen::Matrix3d noise(std::size_t sighting, int fixture) const;

 private:
  void find_pairs(const PoseBelief& belief, const std::vector<int>& near, std::vector<FixtureMatch>& pairs) const;
  void expect(const PoseBelief& belief, const std::vector<int>& near, FrameComparison& result) const;

  const SightingFrame& frame_;
  const ObservationModel& model_;
  const HypothesisParams& params_;
  double reach_;                             // [m] of the view, see ObservationModel
  std::vector<Eigen::Matrix3d> systematic_;  // what constant errors of camera and time may do to each sighting
};

}  // namespace luminav
