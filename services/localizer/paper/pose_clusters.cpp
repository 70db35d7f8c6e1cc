#include "services/localizer/paper/pose_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luminav {
namespace {

/// Which cluster's circle a pose lies in. Each cell of a grid knows the clusters whose circle may reach into it.
class ClusterFinder {
 public:
  ClusterFinder(const ParticleFilter& filter, double radius, double heading_gate)
      : radius_(radius), heading_gate_(heading_gate), low_(filter.low_corner()) {
    const Eigen::Vector2d extent = filter.high_corner() - low_;
    cell_ = std::max(radius, std::sqrt(std::max(1.0, extent.x() * extent.y()) / kMaxCells));
    columns_ = static_cast<int>(extent.x() / cell_) + 1;
    rows_ = static_cast<int>(extent.y() / cell_) + 1;
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  }

  [[nodiscard]] const std::vector<Pose2>& centres() const { return centres_; }
  [[nodiscard]] int find(const Pose2& pose) const {
    for (const int cluster : cells_[index(column_of(pose.x), row_of(pose.y))]) {
      const Pose2& centre = centres_[static_cast<std::size_t>(cluster)];
      if (distance(pose, centre) < radius_ && std::abs(wrap_angle(pose.theta - centre.theta)) < heading_gate_) {
        return cluster;
      }
    }
    return -1;
  }
  void add(const Pose2& centre) {
    const auto cluster = static_cast<int>(centres_.size());
    centres_.push_back(centre);
    for (int row = std::max(0, row_of(centre.y) - 1); row <= std::min(rows_ - 1, row_of(centre.y) + 1); ++row) {
      for (int column = std::max(0, column_of(centre.x) - 1); column <= std::min(columns_ - 1, column_of(centre.x) + 1);
           ++column) {
        cells_[index(column, row)].push_back(cluster);
      }
    }
  }

 private:
  static constexpr double kMaxCells = 1e5;
  [[nodiscard]] int column_of(double x) const {
    return std::clamp(static_cast<int>((x - low_.x()) / cell_), 0, columns_ - 1);
  }
  [[nodiscard]] int row_of(double y) const {
    return std::clamp(static_cast<int>((y - low_.y()) / cell_), 0, rows_ - 1);
  }
  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

  double radius_;        // [m]
  double heading_gate_;  // [rad]
  Eigen::Vector2d low_;
  double cell_ = 1.0;  // [m]
  int columns_ = 1;
  int rows_ = 1;
  std::vector<std::vector<int>> cells_;
  std::vector<Pose2> centres_;
};

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
  ClusterFinder finder(filter, radius, params.heading_gate);
  for (const std::uint32_t i : heaviest(filter, params.starting_share)) {
    if (finder.centres().size() == static_cast<std::size_t>(params.max)) {
      break;
    }
    if (finder.find(filter.pose(i)) < 0) {
      finder.add(filter.pose(i));
    }
  }
  std::vector<ClusterSums> sums(finder.centres().size());
  for (std::size_t i = 0; i < filter.size(); ++i) {
    const Pose2 pose = filter.pose(i);
    const int found = finder.find(pose);
    if (found >= 0) {
      const auto cluster = static_cast<std::size_t>(found);
      sums[cluster].add(pose, filter.weight(i), finder.centres()[cluster]);
    }
  }
  std::vector<PoseCluster> clusters;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    clusters.push_back(sums[i].cluster(finder.centres()[i]));
  }
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const PoseCluster& a, const PoseCluster& b) { return a.weight > b.weight; });
  return clusters;
}

}  // namespace luminav
