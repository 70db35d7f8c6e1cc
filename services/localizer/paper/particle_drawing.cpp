// Where particles are put: anywhere, around a pose, or where what is seen fits.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "services/localizer/paper/particle_filter.hpp"

namespace luminav {

void ParticleFilter::place(std::size_t particle, const Pose2& pose) {
  x_[particle] = static_cast<float>(pose.x);
  y_[particle] = static_cast<float>(pose.y);
  theta_[particle] = static_cast<float>(wrap_angle(pose.theta));
}

void ParticleFilter::draw(std::size_t i) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const Eigen::Vector2d place(random_.uniform(floor_.min().x(), floor_.max().x()),
                                random_.uniform(floor_.min().y(), floor_.max().y()));
    x_[i] = static_cast<float>(place.x());
    y_[i] = static_cast<float>(place.y());
    if (walls_.is_free({x_[i], y_[i]})) {
      break;
    }
  }
  theta_[i] = static_cast<float>(wrap_angle(2.0 * kPi * random_.uniform()));
  weight_[i] = 1.0F / static_cast<float>(count_);
}

void ParticleFilter::draw_facing(std::size_t i, const std::vector<FixtureSighting>& sightings) {
  const auto any_of = [&](std::size_t count) {
    return static_cast<std::size_t>(random_.uniform() * static_cast<double>(count));
  };
  for (int attempt = 0; attempt < 100 && map_.size() > 0; ++attempt) {
    const FixtureSighting& sighting = sightings[any_of(sightings.size())];
    const Fixture& fixture = map_[static_cast<int>(any_of(static_cast<std::size_t>(map_.size())))];
    const double period = sighting.has_theta ? symmetry_period(fixture.shape) : 0.0;
    const double turn = period > 0.0 ? period * std::floor(2.0 * kPi * random_.uniform() / period)  //
                                     : 2.0 * kPi * random_.uniform();
    const Pose2 fixture_as_seen = fixture.world_from_fixture * Pose2{0.0, 0.0, turn};
    const Pose2 pose = fixture_as_seen * sighting.robot_from_fixture.inverse();
    place(i, {pose.x + random_.gauss() / params_.distance_gain, pose.y + random_.gauss() / params_.distance_gain,
              pose.theta + random_.gauss() / params_.angle_gain});
    if (walls_.is_free({x_[i], y_[i]})) {
      weight_[i] = 1.0F / static_cast<float>(count_);
      return;
    }
  }
  draw(i);
}

void ParticleFilter::scatter() {
  for (std::size_t i = 0; i < count_; ++i) {
    draw(i);
  }
  fresh_from_ = 0;
}

void ParticleFilter::redraw_share(const std::vector<FixtureSighting>& sightings) {
  const auto count = static_cast<std::size_t>(params_.facing_share * static_cast<double>(count_));
  for (std::size_t i = std::max(fresh_from_, count_ - count); i < count_; ++i) {
    draw_facing(i, sightings);
  }
  fresh_from_ = count_;
}

void ParticleFilter::gather(const PoseBelief& belief, double share) {
  const auto count = std::min(count_, static_cast<std::size_t>(share * static_cast<double>(count_)));
  const Eigen::Matrix3d root = belief.covariance.llt().matrixL();
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d offset = root * Eigen::Vector3d(random_.gauss(), random_.gauss(), random_.gauss());
    place(i, {belief.pose.x + offset.x(), belief.pose.y + offset.y(), belief.pose.theta + offset.z()});
  }
  fresh_from_ = std::max(fresh_from_, count);
}

}  // namespace luminav
