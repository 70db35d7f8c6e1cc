#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/model/frame_queue.hpp"
#include "services/localizer/model/localizer.hpp"
#include "services/localizer/model/observation_model.hpp"
#include "services/localizer/paper/particle_filter.hpp"
#include "services/localizer/paper/pose_clusters.hpp"
#include "services/localizer/paper/pose_confidence.hpp"
#include "services/localizer/paper/sighting_matcher.hpp"
#include "services/localizer/tracking/correction_record.hpp"

namespace luminav {

/// When the particle filter is updated, when it hands over to the Kalman filter, and when that is given up.
struct HandoverParams {
  double step = 0.2;            // [m] of motion from one update to the next: pictures of one place say one thing
  double turn = radians(23.0);  // [rad] likewise
  double share = 0.8;           // weight of the heaviest cluster
  double spread = 0.25;         // [m]
  double heading_spread = radians(10.0);  // [rad]
  MatchLimits limits;
  double images_per_view = 8.0;  // they share lens, tilt and fixture errors: each counts for that much less
  double blind_distance = 12.0;  // [m] without a match
  double gathered_share = 0.1;   // of the particles that start around the old pose after giving up
};

struct PaperLocalizerParams {
  ParticleParams particles;
  ClusterParams clusters;
  HandoverParams handover;
  ConfidenceParams confidence;
};

/// The paper's localizer: particle filter, clusters, then an extended Kalman filter, and back when confidence is low.
class PaperLocalizer final : public Localizer {
 public:
  PaperLocalizer(const Building& building, const PriorMap& walls, const RobotDescription& robot,
                 const ErrorParams& errors, const PaperLocalizerParams& params, std::uint64_t seed);

  void add_odometry(const OdometryReading& reading) override;
  void add_frame(const SightingFrame& frame) override;
  void add_sonar(const SonarScan&) override {}
  void set_motors_enabled(bool) override {}
  void add_guess(const PoseBelief& guess) override;
  void recall(const PoseBelief& belief) override { follow(belief, "the pose from before the restart"); }
  [[nodiscard]] LocalizerEstimate estimate() const override;
  [[nodiscard]] std::vector<WeightedPose> hypotheses(std::size_t max) const override;
  [[nodiscard]] std::vector<WeightedPose> particles(std::size_t max) const override;
  [[nodiscard]] std::int64_t frames_dropped() const override { return queue_.dropped(); }
  [[nodiscard]] std::int64_t last_frame_used() const override { return queue_.last_used(); }

 private:
  void step(const FrameQueue::TimedFrame& timed);
  void step_particles(const FrameQueue::TimedFrame& timed);
  void step_kalman(const FrameQueue::TimedFrame& timed);
  void move_particles();
  void weigh_candidate(const FrameQueue::TimedFrame& timed);
  void follow(const PoseBelief& belief, const std::string& why);
  void give_up(const std::string& why);

  ObservationModel model_;
  SightingMatcher matcher_;
  PaperLocalizerParams params_;
  FrameQueue queue_;
  ParticleFilter filter_;
  std::vector<PoseCluster> clusters_;
  std::optional<OdometryReading> filter_odometry_;
  std::optional<PoseBelief> belief_;  // of the Kalman filter, while it runs
  std::string reason_ = "no fixture seen yet";
  Pose2 pending_;                     // motion that the particles have not made yet
  std::optional<Pose2> update_odom_;  // odom_from_robot at the last update of the particles
  std::optional<Pose2> view_odom_;    // at the last image that counted for the confidence
  std::optional<Pose2> candidate_;    // the heaviest cluster, as long as it stays the same one
  PoseConfidence confidence_;
  double odometer_ = 0.0;         // [m]
  CorrectionRecord corrections_;  // by the images used
};

}  // namespace luminav
