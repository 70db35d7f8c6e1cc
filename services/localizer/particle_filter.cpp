#include "services/localizer/particle_filter.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace luminav {
namespace {

constexpr double kFarthestFixture = 3.0;  // [m] beyond it a sighting's nearest fixture is no nearer to the truth

}  // namespace

std::uint64_t SplitMix::next() {
  state_ += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

double SplitMix::gauss() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * kPi * uniform());
}

ParticleFilter::ParticleFilter(const FixtureMap& map, const WallField& walls, const ParticleParams& params,
                               std::uint64_t seed)
    : map_(map), walls_(walls), params_(params), random_(seed), least_(-5.0, -5.0), most_(5.0, 5.0) {
  if (walls_.has_walls()) {
    const GridGeometry& geometry = walls_.map().geometry;
    least_ = geometry.origin;
    most_ = geometry.origin + geometry.resolution * Eigen::Vector2d(geometry.columns, geometry.rows);
  } else if (map_.size() > 0) {
    least_ = most_ = map_[0].world_from_fixture.position();
    for (const Fixture& fixture : map_.fixtures()) {
      least_ = least_.cwiseMin(fixture.world_from_fixture.position());
      most_ = most_.cwiseMax(fixture.world_from_fixture.position());
    }
    least_ -= Eigen::Vector2d(2.0, 2.0);
    most_ += Eigen::Vector2d(2.0, 2.0);
  }
  const auto count = static_cast<std::size_t>(std::max(1, params.count));
  for (std::vector<double>* values : {&x_, &y_, &theta_, &weight_}) {
    values->resize(count);
  }
  order_.resize(count);
  scatter();
}

void ParticleFilter::draw(std::size_t i) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    x_[i] = least_.x() + random_.uniform() * (most_.x() - least_.x());
    y_[i] = least_.y() + random_.uniform() * (most_.y() - least_.y());
    if (walls_.is_free({x_[i], y_[i]})) {
      break;
    }
  }
  theta_[i] = wrap_angle(2.0 * kPi * random_.uniform());
  weight_[i] = 1.0 / static_cast<double>(size());
}

void ParticleFilter::scatter() {
  for (std::size_t i = 0; i < size(); ++i) {
    draw(i);
  }
}

void ParticleFilter::gather(const PoseBelief& belief, double share) {
  const auto count = std::min(size(), static_cast<std::size_t>(share * static_cast<double>(size())));
  const Eigen::Matrix3d root = belief.covariance.llt().matrixL();
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d offset = root * Eigen::Vector3d(random_.gauss(), random_.gauss(), random_.gauss());
    x_[i] = belief.pose.x + offset.x();
    y_[i] = belief.pose.y + offset.y();
    theta_[i] = wrap_angle(belief.pose.theta + offset.z());
  }
}

void ParticleFilter::predict(const Pose2& delta) {
  const double way = std::hypot(delta.x, delta.y);
  // below a centimetre the direction of the step is noise
  const double first = way < 0.01 ? 0.0 : std::atan2(delta.y, delta.x);
  const double direction = std::abs(first) > 0.5 * kPi ? -1.0 : 1.0;  // driving backwards is no half turn
  const double first_turn = direction > 0.0 ? first : wrap_angle(first - kPi);
  const double second_turn = wrap_angle(delta.theta - first_turn);
  const double first_sigma = params_.turn_by_turn * std::abs(first_turn) + params_.turn_by_way * way;
  const double way_sigma =
      params_.way_by_way * way + params_.way_by_turn * (std::abs(first_turn) + std::abs(second_turn));
  const double second_sigma = params_.turn_by_turn * std::abs(second_turn) + params_.turn_by_way * way;
  for (std::size_t i = 0; i < size(); ++i) {
    bool is_placed = false;
    for (int attempt = 0; attempt <= params_.redraws && !is_placed; ++attempt) {
      const double turn = first_turn + first_sigma * random_.gauss();
      const double step = direction * way + way_sigma * random_.gauss();
      const double after = second_turn + second_sigma * random_.gauss();
      const double heading = theta_[i] + turn;
      const Eigen::Vector2d place(x_[i] + step * std::cos(heading), y_[i] + step * std::sin(heading));
      if (way < 1e-6 || walls_.is_free(place)) {
        x_[i] = place.x();
        y_[i] = place.y();
        theta_[i] = wrap_angle(heading + after);
        is_placed = true;
      }
    }
    if (!is_placed) {
      weight_[i] = 0.0;  // among the worst, which the next update replaces
    }
  }
}

double ParticleFilter::free_probability(const Eigen::Vector2d& point) const {
  if (!walls_.has_walls()) {
    return 1.0;
  }
  const Cell cell = walls_.map().geometry.cell_at(point);
  if (!walls_.map().geometry.contains(cell)) {
    return params_.least_free;
  }
  switch (walls_.map().at(point)) {
    case Prior::kFree:
      return 1.0;
    case Prior::kUnknown:
      return params_.unknown_free;
    default:
      return params_.least_free;
  }
}

double ParticleFilter::score(const Pose2& pose, const std::vector<FixtureSighting>& sightings) const {
  thread_local std::vector<int> near;
  double sum = 0.0;
  const double scale = 1.0 / params_.distance_gain;
  for (const FixtureSighting& sighting : sightings) {
    const Pose2 projected = pose * sighting.robot_from_fixture;
    near.clear();
    map_.find_near(projected.position(), kFarthestFixture, near);
    int nearest = -1;
    double least = kFarthestFixture * kFarthestFixture;
    for (const int index : near) {
      const double squared = (map_[index].world_from_fixture.position() - projected.position()).squaredNorm();
      if (squared < least) {
        least = squared;
        nearest = index;
      }
    }
    if (nearest < 0) {
      sum += 1.0 / (1.0 + params_.distance_gain * kFarthestFixture + params_.angle_gain * 0.5 * kPi);
      continue;
    }
    const Fixture& fixture = map_[nearest];
    // the distance in the sighting's own covariance: where the image's border cut a fixture, along it counts less
    const Eigen::Vector2d offset =
        pose.inverse() * fixture.world_from_fixture.position() - sighting.robot_from_fixture.position();
    const Eigen::Matrix2d spread =
        sighting.covariance.topLeftCorner<2, 2>() + scale * scale * Eigen::Matrix2d::Identity();
    const double determinant = spread(0, 0) * spread(1, 1) - spread(0, 1) * spread(0, 1);
    const double squared = (spread(1, 1) * offset.x() * offset.x() - 2.0 * spread(0, 1) * offset.x() * offset.y() +
                            spread(0, 0) * offset.y() * offset.y()) /
                           determinant;
    const double away = scale * std::sqrt(std::max(0.0, squared));
    const double period = sighting.has_theta ? symmetry_period(fixture.shape) : 0.0;
    const double turn = std::abs(wrap_modulo(projected.theta - fixture.world_from_fixture.theta, period));
    sum += 1.0 / (1.0 + params_.distance_gain * away + params_.angle_gain * turn);
  }
  return sum / static_cast<double>(sightings.size()) * free_probability(pose.position());
}

void ParticleFilter::update(const std::vector<FixtureSighting>& sightings) {
  if (sightings.empty()) {
    return;
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    // negative weights have no meaning
    weight_[i] = std::max(1e-9, score(pose(i), sightings) + params_.weight_jitter * random_.gauss());
    sum += weight_[i];
  }
  for (double& weight : weight_) {
    weight /= sum;
  }
  resample();
}

void ParticleFilter::resample() {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return weight_[a] > weight_[b]; });
  const auto random = static_cast<std::size_t>(params_.random_share * static_cast<double>(size()));
  const auto copied = static_cast<std::size_t>(params_.copied_share * static_cast<double>(size()));
  for (std::size_t k = 0; k < random; ++k) {
    const std::size_t worst = order_[size() - 1 - k];
    draw(worst);
    weight_[worst] = 1e-9;
  }
  for (std::size_t k = 0; k < copied && random + k + 1 < size(); ++k) {
    const std::size_t from = order_[k];
    const std::size_t to = order_[size() - 1 - random - k];
    x_[to] = x_[from];
    y_[to] = y_[from];
    theta_[to] = theta_[from];
    weight_[to] = weight_[from];
  }
  const double sum = std::accumulate(weight_.begin(), weight_.end(), 0.0);
  for (double& weight : weight_) {
    weight /= sum;
  }
}

std::vector<PoseCluster> find_clusters(const ParticleFilter& filter, double smallest_spacing,
                                       const ClusterParams& params) {
  const double radius = params.radius_factor * std::min(smallest_spacing, 10.0);
  std::vector<std::size_t> left(filter.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::stable_sort(left.begin(), left.end(),
                   [&](std::size_t a, std::size_t b) { return filter.weight(a) > filter.weight(b); });
  std::vector<PoseCluster> clusters;
  while (!left.empty() && clusters.size() < static_cast<std::size_t>(params.most)) {
    const Pose2 seed = filter.pose(left.front());
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
