#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/localizer/ceiling_view.hpp"
#include "services/localizer/driven_trail.hpp"
#include "services/localizer/error_model.hpp"
#include "services/localizer/fixture_map.hpp"
#include "services/localizer/frame_comparison.hpp"
#include "services/localizer/hypothesis.hpp"
#include "services/localizer/sonar_evidence.hpp"
#include "services/localizer/wall_field.hpp"

namespace luminav {

/// All poses that explain what was seen, each with a small Kalman filter and a score. Objects vote once each, however
/// many images showed them; walls, sonar and missing fixtures count beside.
class HypothesisBank {
 public:
  HypothesisBank(const FixtureMap& map, const CeilingView& view, const WallField& walls, double ceiling_height,
                 double wheel_base, const SonarRing& sonar, const ErrorParams& errors, const HypothesisParams& params);

  void clear();
  /// How often the list began anew.
  [[nodiscard]] int beginnings() const { return beginnings_; }
  /// Moves all by an odometry step.
  void advance(const Pose2& delta);
  /// Moves all by a step that no odometry measured, with its covariance in the frame at its beginning. The scene is to
  /// be cleared: what is seen from now on are other objects.
  void bridge(const Pose2& step, const Eigen::Matrix3d& noise);
  /// One image: sightings (rolling shutter taken out) with their object in the scene.
  void observe(const SightingFrame& frame, const std::vector<int>& object_of_sighting, SceneMemory& scene,
               const OdometryReading& odometry, double odometer);
  /// New poses from objects of the scene that have not yet been used for it. Returns how many.
  int seed(SceneMemory& scene, const Pose2& odom_from_robot);
  void listen(const std::vector<PlacedEcho>& echoes);
  /// A guess from outside.
  void add_guess(const PoseBelief& belief, double bonus);
  /// Sorts by score, merges doubles, gives up what is far behind.
  void tidy();

  [[nodiscard]] const std::vector<Hypothesis>& hypotheses() const { return hypotheses_; }
  [[nodiscard]] std::vector<Hypothesis>& hypotheses() { return hypotheses_; }
  /// Score of "all that was seen is something else": what a pose not in the list would have.
  [[nodiscard]] double null_score() const { return null_settled_ + null_active_; }

 private:
  void correct(Hypothesis& hypothesis, const FrameComparer& comparer, const FrameComparison& comparison,
               const SightingFrame& frame, double share) const;
  [[nodiscard]] std::vector<Hypothesis> poses_from(const SeenObject& object, const Pose2& odom_from_robot) const;
  [[nodiscard]] SightingFrame recent_sightings(const SceneMemory& scene, const Pose2& odom_from_robot) const;
  void add(Hypothesis hypothesis);
  [[nodiscard]] bool is_same_place(const Pose2& a, const Pose2& b) const;
  [[nodiscard]] bool is_possible_place(const PoseBelief& belief) const;

  const FixtureMap& map_;
  const CeilingView& view_;
  const WallField& walls_;
  double ceiling_height_;  // [m]
  double wheel_base_;      // [m]
  SonarRing sonar_;
  ErrorParams errors_;
  HypothesisParams params_;
  std::vector<Hypothesis> hypotheses_;
  double null_settled_ = 0.0;
  double null_active_ = 0.0;
  double best_sonar_ = 0.0;
  DrivenTrail trail_;
  double way_since_correction_ = 0.0;  // [m], turns counted in
  int next_id_ = 1;
  int beginnings_ = 0;
};

}  // namespace luminav
