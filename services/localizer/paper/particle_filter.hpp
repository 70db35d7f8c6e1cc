#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "services/common/ceiling/fixture_map.hpp"
#include "services/common/geometry/split_mix.hpp"
#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/model/wall_field.hpp"
#include "services/localizer/paper/nearest_fixture_grid.hpp"

namespace luminav {

enum class ParticleScoring { kEquationOne, kGaussian };
enum class ParticleResampling { kReplaceWorst, kSystematic };

/// 1-sigma of a step of the particles (Thrun et al. 2005, table 5.6: alpha 1 to 4).
struct OdometryNoise {
  double turn_by_turn = 0.1;          // [rad/rad] noise of each turn, by the turn
  double turn_by_distance = 0.05;     // [rad/m] likewise, by the distance
  double distance_by_distance = 0.1;  // [m/m] noise of the distance, by the distance
  double distance_by_turn = 0.05;     // [m/rad] likewise, by both turns
};

/// One odometry step as turn, way, turn, with the deviations of their noise. Thrun et al. 2005, table 5.6.
struct NoisyStep {
  float first_turn = 0.0F;      // [rad]
  float distance = 0.0F;        // [m] negative: backwards
  float second_turn = 0.0F;     // [rad]
  float first_sigma = 0.0F;     // [rad]
  float distance_sigma = 0.0F;  // [m]
  float second_sigma = 0.0F;    // [rad]
};

/// Parameters of the particle filter. The paper's: equation 1 and churn.
struct ParticleParams {
  int count = 0;           // 0 = by the free floor: as many as `density` says
  double density = 200.0;  // [1/m^2]
  ParticleScoring scoring = ParticleScoring::kEquationOne;
  double distance_gain = 1.0 / 0.15;        // [1/m] kd of equation 1: the score is halved at 0.15 m
  double angle_gain = 1.0 / radians(10.0);  // [1/rad] kt of equation 1
  double weight_jitter = 0.01;              // sigma of equation 1's norm term
  double position_sigma = 0.10;             // [m] of a sighting, Gaussian scoring
  double heading_sigma = radians(3.0);      // [rad] likewise
  double outlier = 1e-4;                    // likelihood of a sighting that is something else, likewise
  double unknown_free = 0.5;                // P of a cell the map does not know
  double min_free = 0.05;                   // P of an occupied cell
  OdometryNoise noise{};
  int redraws = 5;  // tries to move a particle without entering a wall
  ParticleResampling resampling = ParticleResampling::kReplaceWorst;
  double drawn_weight = 1.0;   // churn: of a particle drawn anew, in shares of the mean weight
  double copied_share = 0.10;  // churn: the best replace as many of the worst
  double random_share = 0.05;  // of the worst (churn) or of all (systematic) are drawn anew
  double facing_share = 0.5;   // of what is drawn anew: where a sighting fits a fixture; the others anywhere
};

/// Particle filter: odometry with noise inside the free space; each sighting scored against the nearest fixture, by the
/// paper's equation 1 or by a Gaussian; the paper's resampling, in which the best are copied over the worst and some of
/// the worst are drawn anew, or the systematic one. One float array per coordinate, 28 bytes a particle and 4 more for
/// the paper's resampling.
class ParticleFilter {
 public:
  ParticleFilter(const FixtureMap& map, const WallField& walls, const ParticleParams& params, std::uint64_t seed);

  /// Draws all anew in the free space. Of these the next update draws `facing_share` again where its sightings fit:
  /// each alias of the first view gets as many, and none is lost by chance.
  void scatter();
  void predict(const Pose2& delta);
  /// Scores all particles, then resamples; no sightings, no update. At most 8 sightings are used.
  void update(const std::vector<FixtureSighting>& sightings);
  /// Puts a share of the particles around a pose.
  void gather(const PoseBelief& belief, double share);

  /// The score of a pose without equation 1's norm term: mean over the sightings of 1 / (1 + kd d + kt |dtheta|), or
  /// product of the Gaussians, times P(free).
  [[nodiscard]] double score(const Pose2& pose, const std::vector<FixtureSighting>& sightings) const;

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] Pose2 pose(std::size_t i) const { return {x_[i], y_[i], theta_[i]}; }
  [[nodiscard]] double weight(std::size_t i) const { return static_cast<double>(weight_[i]); }
  /// Of all particles together, working space included.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  /// A sighting in the robot frame, and how it is scored.
  struct ScoredSighting {
    Pose2 seen;
    Eigen::Matrix2f metric;   // squared distance = offset' * metric * offset, times the square of equation 1's gain
    float angle_gain = 0.0F;  // of equation 1 [1/rad], or 1 / (2 sigma^2) of a Gaussian; 0 = it has no orientation
  };
  void draw(std::size_t i);
  /// Draws a particle where a fixture of the map looks as one of the sightings does; anywhere if that is in no free
  /// space.
  void draw_facing(std::size_t i, const std::vector<FixtureSighting>& sightings);
  void redraw_share(const std::vector<FixtureSighting>& sightings);
  /// Normal numbers for as many particles as a block has, from the table.
  [[nodiscard]] const float* noise();
  /// Moves a particle that would enter a wall with other noise; it stays where it was if no try is free.
  void move_again(std::size_t particle, const Pose2& from, const NoisyStep& step);
  void place(std::size_t particle, const Pose2& pose);
  [[nodiscard]] ScoredSighting prepare(const FixtureSighting& sighting) const;
  /// Writes the scores of a block of particles.
  void score_block(const float* x, const float* y, const float* theta, const std::vector<ScoredSighting>& sightings,
                   float* scores, std::size_t count) const;
  void weigh(std::size_t begin, std::size_t count, const std::vector<ScoredSighting>& sightings);
  void replace_worst(const std::vector<FixtureSighting>& sightings);
  void resample_systematically();
  void normalise_weights();
  [[nodiscard]] double free_probability(const Eigen::Vector2d& point) const;

  const FixtureMap& map_;
  const WallField& walls_;
  NearestFixtureGrid nearest_;
  ParticleParams params_;
  SplitMix random_;
  std::vector<float> noise_;   // normal numbers; a block of particles takes a stretch that begins anywhere
  Eigen::AlignedBox2d floor_;  // [m] in which particles are drawn
  std::size_t count_;
  std::size_t fresh_from_ = 0;  // nothing was seen since particles from here on were drawn; count_: none
  std::vector<float> x_, y_, theta_, weight_;
  std::vector<float> spare_x_, spare_y_, spare_theta_;  // systematic resampling writes here
  std::vector<std::uint32_t> order_;                    // churn
};

}  // namespace luminav
