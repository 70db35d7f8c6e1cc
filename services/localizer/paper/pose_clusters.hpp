#pragma once

#include <vector>

#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/paper/particle_filter.hpp"

namespace luminav {

struct ClusterParams {
  double radius_factor = 0.45;          // of the smallest distance between fixtures
  double heading_gate = radians(45.0);  // [rad]
  int max = 50;
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
