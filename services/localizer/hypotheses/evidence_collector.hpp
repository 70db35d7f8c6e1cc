#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/localizer/hypotheses/object_tracks.hpp"
#include "services/localizer/hypotheses/sonar_evidence.hpp"
#include "services/localizer/model/observation_model.hpp"
#include "services/localizer/model/pose_belief.hpp"

namespace luminav {

/// What the robot did between the beginnings of two rounds.
struct RoundMotion {
  bool has_moved = false;
  PoseBelief step{{}, Eigen::Matrix3d::Zero()};  // in the robot frame at the first
  double distance = 0.0;                         // [m] of it
  bool settles = false;                          // the scene before is over: relative motion to it is unknown
};

/// What all hypotheses are compared with in one round: an image, and what was driven and heard since the round before.
/// It stays as it is until the last of them has seen it, however many images pass meanwhile.
struct EvidenceRound {
  static constexpr int kMaxImages = 2;  // that one stands for: chance is not averaged out as by many

  bool has_image = false;
  SightingFrame frame;
  OdometryReading odometry;             // at the image's time
  double odometer = 0.0;                // [m] likewise
  double share = 1.0;                   // of the image's constant errors that are drawn anew
  ObjectTracks scene;                   // with this image
  std::vector<ObjectTrack> forgotten;   // since the round before
  std::vector<int> images_of_sighting;  // images that this one stands for
  int images = 1;                       // likewise, whatever they show
  std::vector<PlacedEcho> echoes;       // in the robot frame of the image
  RoundMotion motion;                   // since the round before
};

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
  double distance_since_correction_ = 0.0;  // [m], turns counted in
};

}  // namespace luminav
