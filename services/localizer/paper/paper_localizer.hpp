#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/model/ceiling_view.hpp"
#include "services/localizer/model/error_model.hpp"
#include "services/localizer/model/frame_queue.hpp"
#include "services/localizer/model/localizer.hpp"
#include "services/localizer/model/sighting_model.hpp"
#include "services/localizer/paper/particle_filter.hpp"
#include "services/localizer/paper/pose_clusters.hpp"

namespace luminav {

/// When the particle filter hands over to the Kalman filter, and when the Kalman filter gives up.
struct HandoverParams {
  double share = 0.8;                     // weight of the heaviest cluster
  double runner_up = 0.1;                 // most that the second may have
  double spread = 0.25;                   // [m]
  double heading_spread = radians(10.0);  // [rad]
  int fixtures = 2;                       // different ones seen
  double distance = 1.0;                  // [m] driven
  int held = 10;                          // updates in a row
  double gate = 11.34;                    // chi2(3) at 99 %
  int gate_misses = 15;                   // images in a row whose sightings all fail the gate
  double nis_limit = 3.0;                 // running mean per degree of freedom
  double blind_distance = 12.0;           // [m] without a match
  int absent_frames = 20;                 // images in a row without a fixture that is predicted
  double gathered_share = 0.5;            // of the particles that start around the old pose after giving up
};

struct PaperLocalizerParams {
  ParticleParams particles;
  ClusterParams clusters;
  HandoverParams handover;
};

/// The paper's localizer: particle filter, clusters, then an extended Kalman filter, and back when confidence is low.
class PaperLocalizer final : public Localizer {
 public:
  PaperLocalizer(const Building& building, const PriorMap& walls, const RobotDescription& robot,
                 const ErrorParams& errors, const PaperLocalizerParams& params, std::uint64_t seed);

  void add_odometry(const OdometryReading& reading) override;
  void add_frame(const SightingFrame& frame) override;
  void add_sonar(const SonarScan&) override {}
  void add_base_state(const BaseState&) override {}
  void add_guess(const PoseGuess& guess) override;
  void recall(const PoseBelief& belief) override { filter_.gather(belief, params_.handover.gathered_share); }
  [[nodiscard]] LocalizerEstimate estimate() const override;
  [[nodiscard]] std::vector<WeightedPose> hypotheses(std::size_t max) const override;
  [[nodiscard]] std::vector<WeightedPose> particles(std::size_t max) const override;
  [[nodiscard]] std::int64_t frames_dropped() const override { return queue_.dropped(); }
  [[nodiscard]] std::int64_t last_frame_used() const override { return queue_.last_used(); }

 private:
  void step(const FrameQueue::TimedFrame& timed);
  void step_particles(const SightingFrame& frame);
  void step_kalman(const SightingFrame& frame, const OdometryReading& odometry);
  void remember_fixture(const SightingFrame& frame);
  void give_up(const std::string& why);

  FixtureMap map_;
  CeilingView view_;
  WallField walls_;
  RobotDescription robot_;
  double ceiling_height_;  // [m]
  ErrorParams errors_;
  PaperLocalizerParams params_;
  FrameQueue queue_;
  ParticleFilter filter_;
  std::vector<PoseCluster> clusters_;
  std::optional<OdometryReading> filter_odometry_;
  PoseBelief belief_;
  bool is_kalman_ = false;
  std::string reason_ = "no fixture seen yet";
  bool has_update_ = false;
  double odometer_ = 0.0;           // [m]
  double search_odometer_ = 0.0;    // [m] where the search began
  std::vector<int> seen_fixtures_;  // nearest ones of the heaviest cluster since the search began
  int held_ = 0;
  int gate_misses_ = 0;
  int absent_ = 0;
  double nis_ = 0.0;
  bool has_nis_ = false;
  std::int64_t fixture_utime_ = 0;
  double odometer_at_fixture_ = 0.0;
  std::int64_t guess_id_ = 0;
};

}  // namespace luminav
