#include "services/localizer/paper/pose_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luminav {

std::vector<PoseCluster> find_clusters(const ParticleFilter& filter, double smallest_spacing,
                                       const ClusterParams& params) {
  const double radius = params.radius_factor * std::min(smallest_spacing, 10.0);
  std::vector<std::size_t> left(filter.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  const auto is_lighter = [&](std::size_t a, std::size_t b) { return filter.weight(a) < filter.weight(b); };
  std::vector<PoseCluster> clusters;
  while (!left.empty() && clusters.size() < static_cast<std::size_t>(params.max)) {
    const Pose2 seed = filter.pose(*std::max_element(left.begin(), left.end(), is_lighter));
    std::vector<std::size_t> members;
    std::vector<std::size_t> others;
    for (const std::size_t i : left) {
      const Pose2 pose = filter.pose(i);
      const bool belongs =
          distance(pose, seed) < radius && std::abs(wrap_angle(pose.theta - seed.theta)) < params.heading_gate;
      (belongs ? members : others).push_back(i);
    }
    if (members.empty()) {
      break;  // a radius of 0: two fixtures in one place
    }
    PoseCluster cluster;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();  // relative to the seed, so that the heading is no issue
    for (const std::size_t i : members) {
      const Pose2 pose = filter.pose(i);
      cluster.weight += filter.weight(i);
      mean += filter.weight(i) * Eigen::Vector3d(pose.x - seed.x, pose.y - seed.y, wrap_angle(pose.theta - seed.theta));
    }
    mean /= std::max(1e-300, cluster.weight);
    cluster.belief.pose = {seed.x + mean.x(), seed.y + mean.y(), wrap_angle(seed.theta + mean.z())};
    cluster.belief.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-4).asDiagonal();
    for (const std::size_t i : members) {
      const Pose2 pose = filter.pose(i);
      const Eigen::Vector3d offset(pose.x - cluster.belief.pose.x, pose.y - cluster.belief.pose.y,
                                   wrap_angle(pose.theta - cluster.belief.pose.theta));
      cluster.belief.covariance += filter.weight(i) / std::max(1e-300, cluster.weight) * offset * offset.transpose();
    }
    clusters.push_back(cluster);
    left = std::move(others);
  }
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const PoseCluster& a, const PoseCluster& b) { return a.weight > b.weight; });
  return clusters;
}

}  // namespace luminav
