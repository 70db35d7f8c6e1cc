#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/localizer/ceiling_view.hpp"
#include "services/localizer/error_model.hpp"
#include "services/localizer/fixture_map.hpp"
#include "services/localizer/pose_belief.hpp"
#include "services/localizer/scene_memory.hpp"
#include "services/localizer/sighting_model.hpp"
#include "services/localizer/wall_field.hpp"

namespace luminav {

struct HypothesisParams {
  double gate = 16.27;                 // chi2(3) at 99.9 %
  double misfit = -5.0;                // least log-likelihood of one object: it may be something else than a fixture
  double miss_probability = 0.12;      // that a fixture well inside the image is overlooked during a whole pass
  int frames_for_full_vote = 4;        // images an object needs for its full weight
  int frames_for_full_miss = 8;        // images a fixture must have been missed in for its full weight
  double miss_margin = 0.15;           // [m] from the image border, beside the pose's own error
  double independent_way = 0.5;        // [m] after which a sighting's constant errors count as drawn anew
  double wall_way = 0.3;               // [m] after which a pose in a wall counts again
  double sonar_way = 0.3;              // [m] after which the sonars count again
  double sonar_turn = radians(30.0);   // [rad] likewise
  double sonar_weight = 0.3;           // of one echo: neighbouring echoes tell the same
  double sonar_cap = 14.0;             // most that sonar alone can hold against a hypothesis
  double prune = 20.0;                 // log-score behind the best at which a hypothesis is given up
  double merge_distance = 0.3;         // [m] two hypotheses nearer than this and
  double merge_angle = radians(12.0);  // [rad] this are one
  double seed_position_sigma = 0.40;   // [m] sightings less sharp make no hypotheses
  int most = 20000;                    // hypotheses kept
};

/// The likelihood of one object under one hypothesis, averaged over its images.
struct ObjectVote {
  int object = 0;
  int fixture = -1;  // matched last; -1 = none
  double weight = 0.0;
  double weighted_sum = 0.0;
  int frames = 0;
  int matches = 0;
};

/// A fixture that a hypothesis expects to be seen.
struct FixtureWatch {
  int fixture = 0;
  int expected = 0;       // images in which it should be well visible
  int missed = 0;         // of these, nothing was there
  double odometer = 0.0;  // [m] when last expected
};

/// One pose held for possible. Scores are logs of likelihood ratios; 0 = everything seen is explained.
struct Hypothesis {
  int id = 0;
  PoseBelief belief;
  double settled = 0.0;  // of objects and passes that are over
  double walls = 0.0;
  double sonar = 0.0;
  double bonus = 0.0;  // prior: a user's guess, an earlier pose
  double total = 0.0;  // sum of all, kept up to date by the bank
  std::vector<ObjectVote> votes;
  std::vector<FixtureWatch> watches;
  std::vector<int> confirmed;   // different fixtures that fitted, at most 16
  std::int64_t last_match = 0;  // [us]
};

/// What one image says about one pose: which fixture each sighting is, and which fixtures should have been seen.
struct FrameComparison {
  std::vector<int> fixture_of_sighting;  // -1 = fits none
  std::vector<double> log_likelihood;    // of each sighting
  std::vector<Innovation> innovations;   // of those that fit
  std::vector<int> missed;               // fixtures well in view with nothing there
  std::vector<int> expected;             // fixtures well in view
};

/// All poses that explain what was seen, each with a small Kalman filter and a score. Objects vote once each, however
/// many images showed them; walls, sonar and missing fixtures count beside.
class HypothesisBank {
 public:
  HypothesisBank(const FixtureMap& map, const CeilingView& view, const WallField& walls, double ceiling_height,
                 double wheel_base, const SonarRing& sonar, const ErrorParams& errors, const HypothesisParams& params);

  void clear();
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
  /// Echo end points in the robot frame at the bank's time, with the place of their disc.
  struct Echo {
    Eigen::Vector2d disc;
    Eigen::Vector2d end;
    double range = 0.0;
  };
  void listen(const std::vector<Echo>& echoes);
  /// A guess from outside.
  void add_guess(const PoseBelief& belief, double bonus);
  /// Sorts by score, merges doubles, gives up what is far behind.
  void tidy();

  [[nodiscard]] const std::vector<Hypothesis>& hypotheses() const { return hypotheses_; }
  [[nodiscard]] std::vector<Hypothesis>& hypotheses() { return hypotheses_; }
  /// Score of "all that was seen is something else": what a pose not in the list would have.
  [[nodiscard]] double null_score() const { return null_settled_ + null_active_; }

 private:
  /// What constant errors of camera and time may do to each sighting, the same whichever fixture and pose it is.
  [[nodiscard]] std::vector<Eigen::Matrix3d> systematic_errors(const SightingFrame& frame, double linear,
                                                               double angular) const;
  [[nodiscard]] FrameComparison compare(const PoseBelief& belief, const SightingFrame& frame,
                                        const std::vector<Eigen::Matrix3d>& systematic) const;
  void vote(Hypothesis& hypothesis, const SeenObject& object, int fixture, double log_likelihood, double weight);
  void settle(Hypothesis& hypothesis, const SceneMemory& scene, double odometer);
  void score(Hypothesis& hypothesis) const;
  /// Score of votes and watches that are over, moved out of a hypothesis.
  void settle(Hypothesis& hypothesis, std::vector<ObjectVote> votes, std::vector<FixtureWatch> watches) const;
  void add(Hypothesis hypothesis);
  [[nodiscard]] bool is_taken(const Pose2& pose) const;
  [[nodiscard]] bool is_possible_place(const PoseBelief& belief) const;

  const FixtureMap& map_;
  const CeilingView& view_;
  const WallField& walls_;
  double height_above_camera_;  // [m] of the ceiling
  double view_radius_;          // [m]
  double wheel_base_;           // [m]
  SonarRing sonar_;
  ErrorParams errors_;
  HypothesisParams params_;
  std::vector<Hypothesis> hypotheses_;
  double null_settled_ = 0.0;
  double null_active_ = 0.0;
  double best_sonar_ = 0.0;
  double way_since_correction_ = 0.0;  // [m], turns counted in
  int next_id_ = 1;
};

}  // namespace luminav
