#pragma once

#include <vector>

#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/paper/particle_filter.hpp"

namespace luminav {

struct ClusterParams {
  double radius_factor = 0.45;          // of the smallest distance between fixtures
  double heading_gate = radians(45.0);  // [rad]
  double starting_share = 0.10;         // of the particles, the heaviest: a cluster begins with one of them
  int max = 50;
};

/// Particles that belong together.
struct PoseCluster {
  PoseBelief belief;    // weighted mean (circular for the heading) and spread
  double weight = 0.0;  // share of all
};

/// The paper's greedy clusters: in order of weight a particle joins the cluster in whose radius it lies, or begins one;
/// heaviest cluster first.
std::vector<PoseCluster> find_clusters(const ParticleFilter& filter, double smallest_spacing,
                                       const ClusterParams& params);

}  // namespace luminav
