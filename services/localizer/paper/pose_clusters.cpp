#include "services/localizer/paper/pose_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luminav {
namespace {

/// The first of the clusters in whose circle a pose lies; as many as there are: none.
std::size_t find_cluster(const std::vector<Pose2>& centres, const Pose2& pose, double radius, double heading_gate) {
  const auto found = std::find_if(centres.begin(), centres.end(), [&](const Pose2& centre) {
    const double dx = pose.x - centre.x;
    const double dy = pose.y - centre.y;
    return dx * dx + dy * dy < radius * radius && std::abs(wrap_angle(pose.theta - centre.theta)) < heading_gate;
  });
  return static_cast<std::size_t>(found - centres.begin());
}

/// Sums of what a cluster's particles are, relative to its first one, so that the heading is no issue.
struct ClusterSums {
  double weight = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();

  void add(const Pose2& pose, double share, const Pose2& centre) {
    const Eigen::Vector3d offset(pose.x - centre.x, pose.y - centre.y, wrap_angle(pose.theta - centre.theta));
    weight += share;
    mean += share * offset;
    square += share * offset * offset.transpose();
  }
  [[nodiscard]] PoseCluster cluster(const Pose2& centre) const {
    const double scale = 1.0 / std::max(1e-300, weight);
    const Eigen::Vector3d off = scale * mean;
    PoseCluster cluster;
    cluster.weight = weight;
    cluster.belief.pose = {centre.x + off.x(), centre.y + off.y(), wrap_angle(centre.theta + off.z())};
    cluster.belief.covariance = scale * square - off * off.transpose() + 1e-4 * Eigen::Matrix3d::Identity();
    return cluster;
  }
};

/// The heaviest particles, in order of importance: no cluster begins with another one.
std::vector<std::uint32_t> heaviest(const ParticleFilter& filter, double share) {
  std::vector<std::uint32_t> order(filter.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto is_heavier = [&](std::uint32_t a, std::uint32_t b) {
    const double first = filter.weight(a);
    const double second = filter.weight(b);
    return first > second || (first == second && a < b);
  };
  const auto count = static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(filter.size())));
  std::nth_element(order.begin(), order.begin() + count - 1, order.end(), is_heavier);
  std::sort(order.begin(), order.begin() + count, is_heavier);
  order.resize(static_cast<std::size_t>(count));
  return order;
}

}  // namespace

std::vector<PoseCluster> find_clusters(const ParticleFilter& filter, double smallest_spacing,
                                       const ClusterParams& params) {
  const double radius = params.radius_factor * std::clamp(smallest_spacing, 0.1, 10.0);
  std::vector<Pose2> centres;
  const auto find = [&](const Pose2& pose) { return find_cluster(centres, pose, radius, params.heading_gate); };
  for (const std::uint32_t i : heaviest(filter, params.starting_share)) {
    if (centres.size() == static_cast<std::size_t>(params.max)) {
      break;
    }
    if (find(filter.pose(i)) == centres.size()) {
      centres.push_back(filter.pose(i));
    }
  }
  std::vector<ClusterSums> sums(centres.size());
  for (std::size_t i = 0; i < filter.size(); ++i) {
    const Pose2 pose = filter.pose(i);
    if (const std::size_t cluster = find(pose); cluster < centres.size()) {
      sums[cluster].add(pose, filter.weight(i), centres[cluster]);
    }
  }
  std::vector<PoseCluster> clusters;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    clusters.push_back(sums[i].cluster(centres[i]));
  }
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const PoseCluster& a, const PoseCluster& b) { return a.weight > b.weight; });
  return clusters;
}

}  // namespace luminav
