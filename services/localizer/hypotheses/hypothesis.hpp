#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/common/geometry/angle.hpp"
#include "services/localizer/hypotheses/object_tracks.hpp"
#include "services/localizer/model/pose_belief.hpp"

namespace luminav {

struct HypothesisParams {
  double gate = 16.27;                  // chi2(3) at 99.9 %
  double misfit = -6.5;                 // least log-likelihood of one object: it may be something else than a fixture
  double miss_probability = 0.12;       // that a fixture well inside the image is overlooked during a whole pass
  int frames_for_full_vote = 4;         // images an object needs for its full weight
  int frames_for_full_miss = 8;         // images a fixture must have been missed in for its full weight
  double miss_margin = 0.15;            // [m] from the image border, beside the pose's own error
  double decorrelation_distance = 0.5;  // [m] after which a sighting's constant errors count as drawn anew
  double wall_test_distance = 0.3;      // [m] after which a pose in a wall counts again
  double sonar_test_distance = 0.3;     // [m] after which the sonars count again
  double sonar_turn = radians(30.0);    // [rad] likewise
  double sonar_surface = 0.5;           // [m] of wall or thing that counts once, however often it is heard
  int sonar_looks = 4;                  // echoes from there that it takes for its full weight
  double sonar_weight = 2.0;            // of a surface
  double sonar_cap = 14.0;              // most that sonar alone can hold against a hypothesis
  double prune = 20.0;                  // log-score behind the best at which a hypothesis is given up
  double merge_distance = 0.3;          // [m] two hypotheses nearer than this and
  double merge_angle = radians(12.0);   // [rad] this are one
  double seed_position_sigma = 0.40;    // [m] sightings less sharp make no hypotheses
  int max = 20000;                      // hypotheses kept
  int work = 32000;                     // units of work in one step, see WorkBudget
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
struct FixtureAbsence {
  int fixture = 0;
  int expected = 0;       // images in which it should be well visible
  int missed = 0;         // of these, nothing was there
  double odometer = 0.0;  // [m] when last expected
};

/// One pose held for possible. Scores are logs of likelihood ratios; 0 = everything seen is explained.
struct Hypothesis {
  int id = 0;
  PoseBelief belief;
  double closed_score = 0.0;  // of objects and passes that are over
  double walls = 0.0;
  double sonar = 0.0;
  double log_prior = 0.0;      // prior: a user's guess, an earlier pose
  double log_posterior = 0.0;  // sum of all when ranked last
  double sonar_part = 0.0;     // of that: what the sonars hold against it, at most 0
  std::vector<ObjectVote> votes;
  std::vector<FixtureAbsence> absences;
  std::vector<int> confirmed;       // different fixtures that fitted, at most 16
  std::int64_t last_match = 0;      // [us]
  std::int64_t last_explained = 0;  // [us] likewise, or what was seen hangs where the file need not list it

  [[nodiscard]] double without_sonar() const { return log_posterior - sonar_part; }
};

/// Counts an image of an object: `fixture` is what it is taken for there, -1 = none; a weight below 1 for a cut one. It
/// stands for as many `images`.
void add_evidence(Hypothesis& hypothesis, const ObjectTrack& object, int fixture, double log_likelihood, double weight,
                  int images);

/// Counts an image in which fixtures ought to be well visible; those `missed` among them are not seen. It stands for as
/// many `images`.
void add_absence(Hypothesis& hypothesis, std::span<const int> expected, std::span<const int> missed, double odometer,
                 int images);

/// What the sonars hold against a hypothesis, at most 0; `best_sonar` is the best sonar score of all hypotheses.
[[nodiscard]] double held_by_sonar(const Hypothesis& hypothesis, double best_sonar, const HypothesisParams& params);

/// What `log_posterior` should be; `best_sonar` is the best sonar score of all hypotheses.
[[nodiscard]] double score_of(const Hypothesis& hypothesis, double best_sonar, const HypothesisParams& params);

/// Log-likelihood of an object that hangs where the building's file need not list it.
[[nodiscard]] double log_likelihood_unlisted(const ObjectTrack& object);
/// Score of objects if all are something else than listed fixtures: what a pose that no list holds has. With
/// `may_be_unlisted` it comes from where the file need not list them.
[[nodiscard]] double score_of_misfits(std::span<const ObjectTrack> objects, bool may_be_unlisted,
                                      const HypothesisParams& params);

/// Two poses so near each other that they are one hypothesis.
[[nodiscard]] bool is_same_place(const Pose2& a, const Pose2& b, const HypothesisParams& params);

/// Moves the score of objects that were `forgotten` and of fixtures passed by to `closed_score`.
void settle_what_is_over(Hypothesis& hypothesis, std::span<const ObjectTrack> forgotten, double odometer,
                         const HypothesisParams& params);

/// Moves the score of all objects and fixtures to `closed_score`.
void settle_all(Hypothesis& hypothesis, const HypothesisParams& params);

}  // namespace luminav
