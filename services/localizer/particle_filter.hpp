#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "services/localizer/fixture_map.hpp"
#include "services/localizer/pose_belief.hpp"
#include "services/localizer/wall_field.hpp"

namespace luminav {

/// Parameters of the paper's particle filter.
struct ParticleParams {
  int count = 2000;
  double distance_gain = 1.0 / 0.15;        // [1/m] kd of equation 1: the score is halved at 0.15 m
  double angle_gain = 1.0 / radians(10.0);  // [1/rad] kt of equation 1
  double weight_jitter = 0.01;              // sigma of equation 1's norm term
  double unknown_free = 0.5;                // P of a cell the map does not know
  double least_free = 0.05;                 // P of an occupied cell
  double turn_by_turn = 0.1;                // odometry noise: [rad/rad] (Thrun et al. 2005, table 5.6: alpha 1 .. 4)
  double turn_by_way = 0.05;                // [rad/m]
  double way_by_way = 0.1;                  // [m/m]
  double way_by_turn = 0.05;                // [m/rad]
  int redraws = 5;                          // tries to move a particle without entering a wall
  double copied_share = 0.10;               // the best replace as many of the worst
  double random_share = 0.05;               // of the worst are drawn anew
};

/// A small generator whose numbers are the same on every machine. Steele et al. 2014 (splitmix64).
class SplitMix {
 public:
  explicit SplitMix(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  /// In [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  /// Mean 0, deviation 1. Box and Muller 1958.
  double gauss();

 private:
  std::uint64_t state_;
};

/// The paper's particle filter: odometry with noise inside the free space, equation 1, and its own resampling, in which
/// the best are copied over the worst and some of the worst are drawn anew. One array per coordinate.
class ParticleFilter {
 public:
  ParticleFilter(const FixtureMap& map, const WallField& walls, const ParticleParams& params, std::uint64_t seed);

  /// Draws all anew in the free space.
  void scatter();
  void predict(const Pose2& delta);
  /// Equation 1 for all particles, then the resampling; no sightings, no update.
  void update(const std::vector<FixtureSighting>& sightings);
  /// Puts a share of the particles around a pose.
  void gather(const PoseBelief& belief, double share);

  /// Equation 1 without its norm term: mean over the sightings of 1 / (1 + kd d + kt |dtheta|), times P(free).
  [[nodiscard]] double score(const Pose2& pose, const std::vector<FixtureSighting>& sightings) const;

  [[nodiscard]] std::size_t size() const { return x_.size(); }
  [[nodiscard]] Pose2 pose(std::size_t i) const { return {x_[i], y_[i], theta_[i]}; }
  [[nodiscard]] double weight(std::size_t i) const { return weight_[i]; }

 private:
  void draw(std::size_t i);
  void resample();
  [[nodiscard]] double free_probability(const Eigen::Vector2d& point) const;

  const FixtureMap& map_;
  const WallField& walls_;
  ParticleParams params_;
  SplitMix random_;
  Eigen::Vector2d least_;  // [m] corners of where fixtures are, for buildings without a map
  Eigen::Vector2d most_;
  std::vector<double> x_, y_, theta_, weight_;
  std::vector<std::size_t> order_;
};

struct ClusterParams {
  double radius_factor = 0.45;          // of the smallest distance between fixtures
  double heading_gate = radians(45.0);  // [rad]
  int most = 50;
};

/// Particles that belong together.
struct PoseCluster {
  PoseBelief belief;    // weighted mean (circular for the heading) and spread
  double weight = 0.0;  // share of all
};

/// The paper's greedy clusters: from the heaviest particle left, all within the radius; heaviest cluster first.
std::vector<PoseCluster> find_clusters(const ParticleFilter& filter, double smallest_spacing,
                                       const ClusterParams& params);

}  // namespace luminav
