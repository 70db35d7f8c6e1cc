#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/hypotheses/echo_collector.hpp"
#include "services/localizer/hypotheses/hypothesis_bank.hpp"
#include "services/localizer/hypotheses/pose_alternatives.hpp"
#include "services/localizer/integrity/integrity_model.hpp"
#include "services/localizer/integrity/motion_by_sonar.hpp"
#include "services/localizer/integrity/odometry_consistency.hpp"
#include "services/localizer/integrity/pose_monitor.hpp"
#include "services/localizer/integrity/tracking_supervisor.hpp"
#include "services/localizer/model/frame_queue.hpp"
#include "services/localizer/model/localizer.hpp"
#include "services/localizer/model/observation_model.hpp"
#include "services/localizer/model/odometry_gap.hpp"
#include "services/localizer/tracking/correction_record.hpp"
#include "services/localizer/tracking/tracking_filter.hpp"

namespace luminav {

struct ModernLocalizerParams {
  HypothesisParams hypotheses;
  TrackingRules rules;
};

/// Finds the pose among the finite list that the fixtures allow, then follows it with a Kalman filter and watches for
/// signs that it is wrong.
class ModernLocalizer final : public Localizer {
 public:
  ModernLocalizer(const Building& building, const PriorMap& walls, const RobotDescription& robot,
                  const ErrorParams& errors, const ModernLocalizerParams& params);

  void add_odometry(const OdometryReading& reading) override;
  void add_frame(const SightingFrame& frame) override;
  void add_sonar(const SonarScan& scan) override { echoes_.add(scan); }
  void set_motors_enabled(bool enabled) override { motors_enabled_ = enabled; }
  void add_guess(const PoseBelief& guess) override;
  void recall(const PoseBelief& belief) override;
  [[nodiscard]] LocalizerEstimate estimate() const override;
  [[nodiscard]] std::vector<WeightedPose> hypotheses(std::size_t max) const override {
    return weigh(bank_, since_filter(), max);
  }
  [[nodiscard]] std::vector<WeightedPose> particles(std::size_t) const override { return {}; }
  [[nodiscard]] std::int64_t frames_dropped() const override { return queue_.dropped(); }
  [[nodiscard]] std::int64_t last_frame_used() const override { return queue_.last_used(); }

  [[nodiscard]] const HypothesisBank& bank() const { return bank_; }
  [[nodiscard]] const TrackingFilter& filter() const { return filter_; }

 private:
  void step(const FrameQueue::TimedFrame& timed);
  /// Somebody moves the robot: nothing is concluded from an image, and what follows fixtures by sight goes on so.
  void wait_for_rest(const SightingFrame& frame, const OdometryReading& odometry);
  /// That is over.
  void begin_at_rest();
  /// The filter saw fixtures where it predicted them all the time while somebody moved the robot.
  [[nodiscard]] bool is_followed() const;
  void advance(const OdometryReading& odometry);
  void listen(std::int64_t until_utime);
  [[nodiscard]] SightingFrame usable_sightings(const SightingFrame& frame, const OdometryReading& odometry) const;
  void track(const SightingFrame& frame, const OdometryReading& odometry);
  /// What fits nothing where the robot is held to be may be a fixture that hangs elsewhere, or that a robot sees which
  /// slipped or was bumped: the filter becomes that of both, weighed by the fixture's direction and what the sonars
  /// heard. Far off, or where somebody may have carried it, the robot is searched for elsewhere.
  void suspect(Contradiction contradiction, const SightingFrame& frame, const OdometryReading& odometry);
  /// Which sighting is which fixture, for a pose as well known as the filter's.
  [[nodiscard]] std::vector<FixtureMatch> find_matches(const TrackingFilter& filter, const SightingFrame& frame,
                                                       const OdometryReading& odometry) const;
  /// Returns the normalised innovation squared of each match.
  std::vector<double> correct(TrackingFilter& filter, const SightingFrame& frame,
                              const std::vector<FixtureMatch>& matches, const OdometryReading& odometry) const;
  void correct_filter(const SightingFrame& frame, const std::vector<FixtureMatch>& matches,
                      const OdometryReading& odometry);
  /// What the images that wait for odometry say already: the filter itself takes them up when it is there.
  void look_ahead(LocalizerEstimate& estimate) const;
  /// Relative motion across now is unknown: the pose is only as good as a guess of it.
  void bridge(const std::string& why, const OdometryGap& gap);
  /// Puts a tracked pose in doubt if the sonars heard motion since the last fixture that the wheels do not tell.
  void doubt_after_motion();
  void decide(const SightingFrame& frame);
  [[nodiscard]] Pose2 since_filter() const;
  /// Way [m] that bank and filter went since the filter matched a fixture.
  [[nodiscard]] double distance_since_fixture() const { return corrections_.distance_since(odometer_); }

  ObservationModel model_;
  ModernLocalizerParams params_;
  FrameQueue queue_;
  ObjectTracks tracks_;
  HypothesisBank bank_;
  TrackingFilter filter_;
  PoseMonitor monitor_;
  OdometryConsistency displacement_;
  TrackingSupervisor supervisor_;
  MotionBySonar motion_;
  EchoCollector echoes_;
  std::optional<OdometryReading> filter_odometry_;  // where bank and filter stand
  double odometer_ = 0.0;                           // [m]
  CorrectionRecord corrections_;                    // of the filter

  bool is_displaced_ = false;  // somebody moved the robot at the last image
  int images_unmatched_ = 0;   // then, in a row, without a fixture that the filter predicted
  bool motors_enabled_ = true;
};

}  // namespace luminav
