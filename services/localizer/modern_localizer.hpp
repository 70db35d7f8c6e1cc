#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/frame_queue.hpp"
#include "services/localizer/hypothesis_bank.hpp"
#include "services/localizer/localizer.hpp"
#include "services/localizer/tracking_filter.hpp"

namespace luminav {

/// When one hypothesis counts as the truth, and when no longer.
struct TrackingRules {
  double enter_margin = 9.0;                  // log-score ahead of every other pose, listed or not
  double leave_margin = 3.0;                  // below this another pose is possible again
  int enter_fixtures = 2;                     // different fixtures that must have fitted
  double enter_position_sigma = 0.14;         // [m] largest axis
  double leave_position_sigma = 0.16;         // [m] largest axis: beyond, 0.5 m are no longer two deviations away
  double leave_heading_sigma = radians(9.0);  // [rad]
  int misfit_frames = 5;                      // images in a row in which what is seen fits nothing
  int vanish_frames = 7;                      // images without a fixture that was there, the robot standing still
  double still_distance = 0.02;               // [m] since the last match: the robot stands still
  double still_turn = radians(1.5);           // [rad] likewise
  int pause_frames = 10;                      // images in a row without wheel motion: the robot may have been carried
  int miss_frames = 10;                       // images without a fixture that ought to be there
  int miss_fixtures = 2;                      // so many of them, and nothing else seen meanwhile ...
  double miss_distance = 1.5;                 // [m] ... or one of them over this way
  double visible_margin = 0.03;               // [m] from the image border, beside twice the pose's own error
  double vanish_share = 0.5;                  // of a fixture seen just before that must be in view to miss it
  double miss_share = 0.8;                    // likewise of any other fixture
  double bonus_after_misfit = 6.0;            // prior of the old pose when what was seen did not fit it
  double bonus_after_miss = 10.0;             // prior of the old pose when only something was missing
  double guess_bonus = 6.0;                   // prior of a user's guess
  int restart_frames = 12;                    // images with sightings that no hypothesis explains: begin anew
};

struct ModernLocalizerParams {
  HypothesisParams hypotheses;
  TrackingParams tracking;
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
  void add_sonar(const SonarScan& scan) override;
  void add_base_state(const BaseState& state) override;
  void add_guess(const PoseGuess& guess) override;
  [[nodiscard]] LocalizerEstimate estimate() const override;
  [[nodiscard]] std::vector<WeightedPose> hypotheses(std::size_t most) const override;
  [[nodiscard]] std::vector<WeightedPose> particles(std::size_t) const override { return {}; }
  [[nodiscard]] std::int64_t frames_dropped() const override { return queue_.dropped(); }

  [[nodiscard]] const HypothesisBank& bank() const { return bank_; }
  [[nodiscard]] const TrackingFilter& filter() const { return filter_; }

 private:
  struct Match {
    std::size_t sighting = 0;
    int fixture = 0;
    double nis = 0.0;
  };
  void step(const FrameQueue::TimedFrame& timed);
  void advance(const OdometryReading& odometry);
  void listen(std::int64_t until_utime);
  [[nodiscard]] SightingFrame usable_sightings(const SightingFrame& frame, const OdometryReading& odometry) const;
  [[nodiscard]] std::vector<Match> match(const SightingFrame& frame, const OdometryReading& odometry) const;
  void track(const SightingFrame& frame, const std::vector<int>& objects, const OdometryReading& odometry);
  void correct_filter(const SightingFrame& frame, const std::vector<Match>& matches, const OdometryReading& odometry);
  void watch(const SightingFrame& frame, const std::vector<int>& objects, const std::vector<Match>& matches);
  void note_pause();
  [[nodiscard]] std::optional<int> count_missing(const SightingFrame& frame);
  void doubt(const std::string& why, double bonus);
  void decide(const SightingFrame& frame);
  void relative_motion_lost(const std::string& why);
  [[nodiscard]] const Hypothesis* leader() const;

  Building building_;
  FixtureMap map_;
  CeilingView view_;
  WallField walls_;
  RobotDescription robot_;
  ModernLocalizerParams params_;
  FrameQueue queue_;
  SceneMemory scene_;
  HypothesisBank bank_;
  TrackingFilter filter_;
  std::optional<OdometryReading> filter_odometry_;  // where bank and filter stand
  double odometer_ = 0.0;                           // [m]
  std::vector<SonarEcho> echoes_;
  double way_since_sonar_ = 1e9;   // [m]
  double turn_since_sonar_ = 0.0;  // [rad]

  LocalizerState state_ = LocalizerState::kLost;
  std::string reason_ = "no fixture seen yet";
  int leader_id_ = 0;                 // hypothesis that the filter follows; 0 = none
  bool wide_ = false;                 // the filter's covariance is too wide to call it tracking
  std::string doubt_;                 // why the leader was put in doubt; "" = it is not
  int misfit_run_ = 0;                // images
  std::map<int, int> missed_frames_;  // images since the last match that ought to show a fixture and do not
  std::set<int> unreliable_;          // fixtures that were missed though the pose was right: no longer missed
  int doubt_fixture_ = -1;            // whose absence put the leader in doubt; -1 = something else
  int doubted_id_ = 0;                // hypothesis that was put in doubt last
  std::vector<int> seen_lately_;      // fixtures of the last match
  Pose2 odom_at_frame_;               // odom_from_robot at the image before
  int still_frames_ = 0;              // images in a row without wheel motion
  bool paused_ = false;               // it stood still for a while since the last match
  Pose2 odom_at_match_;               // odom_from_robot at the last match
  int unexplained_run_ = 0;           // images
  std::int64_t fixture_utime_ = 0;
  double odometer_at_fixture_ = 0.0;  // [m]
  double nis_ = 0.0;
  bool has_nis_ = false;
  std::int64_t guess_id_ = 0;
};

}  // namespace luminav
