#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/localizer/hypotheses/evidence_round.hpp"
#include "services/localizer/hypotheses/trajectory_check.hpp"
#include "services/localizer/model/observation_model.hpp"

namespace luminav {

/// Collects what is driven, heard and seen while one round of evidence goes on, for the next.
class EvidenceCollector {
 public:
  /// An image's constant errors count as drawn anew after `decorrelation_distance` [m]. The model must outlive this.
  EvidenceCollector(const ObservationModel& model, double decorrelation_distance)
      : model_(model), decorrelation_distance_(decorrelation_distance) {}

  /// Forgets all but how many images passed, and how far away the last round with one was.
  void clear();
  /// An odometry step.
  void advance(const Pose2& delta);
  /// A step that no odometry measured, with its covariance in the frame at its beginning: the scene is over.
  void bridge(const Pose2& step, const Eigen::Matrix3d& noise);
  /// Echoes in the robot frame of the next round's image, in place of those before.
  void listen(const std::vector<PlacedEcho>& echoes) { echoes_ = echoes; }
  /// One more image, and the objects that were forgotten with it.
  void add_image(const std::vector<ObjectTrack>& forgotten);
  /// Gives a round that begins, its image already in it, all that was collected, and begins anew.
  void hand_over(EvidenceRound& round);

  /// Since the round began.
  [[nodiscard]] const RoundMotion& motion() const { return motion_; }

 private:
  const ObservationModel& model_;
  double decorrelation_distance_;  // [m]
  RoundMotion motion_;
  std::vector<PlacedEcho> echoes_;
  std::vector<ObjectTrack> forgotten_;
  int images_ = 0;
  TrajectoryCheck trail_;
  bool has_stretch_ = false;
  double distance_since_correction_ = 0.0;  // [m], turns counted in
};

}  // namespace luminav
