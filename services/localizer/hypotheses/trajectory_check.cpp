#include "services/localizer/hypotheses/trajectory_check.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace luminav {
namespace {

constexpr double kPointEvery = 0.2;  // [m]
constexpr double kStretch = 0.6;     // [m] compared at once, beside as much of the one before
constexpr double kMinRoom = 0.10;    // [m] from the robot's middle to a wall; cells are a tenth of a metre
constexpr double kMapError = 0.10;   // [m] 1-sigma of walls, beside the belief's own
constexpr double kMin = -8.0;        // of one stretch: the map may be wrong
constexpr double kNoOffence = 0.15;  // [m] as near as that is no sign of a wrong pose
constexpr std::array kShifts{kNoOffence, 0.3, 0.45, 0.6, 0.8};  // [m]

}  // namespace

void TrajectoryCheck::clear() {
  poses_.clear();
  distance_since_ = 0.0;
}

bool TrajectoryCheck::advance(const Pose2& delta) {
  now_ = now_ * delta;
  distance_since_ += std::hypot(delta.x, delta.y);
  if (poses_.empty() || distance(poses_.back(), now_) >= kPointEvery) {
    poses_.push_back(now_);
  }
  if (distance_since_ < kStretch) {
    return false;
  }
  distance_since_ = 0.0;
  constexpr auto kMax = static_cast<std::size_t>(2.0 * kStretch / kPointEvery) + 1;
  if (poses_.size() > kMax) {
    poses_.erase(poses_.begin(), poses_.end() - kMax);
  }
  return true;
}

std::vector<Eigen::Vector2d> TrajectoryCheck::points() const {
  std::vector<Eigen::Vector2d> points;
  points.reserve(poses_.size());
  for (const Pose2& pose : poses_) {
    points.push_back((now_.inverse() * pose).position());
  }
  return points;
}

double log_likelihood_of_trail(const PoseBelief& belief, const std::vector<Eigen::Vector2d>& trail,
                               const WallField& walls) {
  if (!walls.has_walls()) {
    return 0.0;
  }
  const PointTransform world_from_robot(belief.pose);
  const auto is_possible = [&](const Eigen::Vector2d& shift) {
    return std::all_of(trail.begin(), trail.end(), [&](const Eigen::Vector2d& point) {
      return walls.distance_to_wall(world_from_robot * point + shift) >= kMinRoom;
    });
  };
  if (is_possible(Eigen::Vector2d::Zero())) {
    return 0.0;
  }
  const Eigen::Matrix2d information =
      (belief.covariance.topLeftCorner<2, 2>() + kMapError * kMapError * Eigen::Matrix2d::Identity()).inverse();
  double best = kMin;
  for (const double length : kShifts) {
    for (int direction = 0; direction < 8; ++direction) {
      const double angle = 0.25 * kPi * direction;
      const Eigen::Vector2d shift = length * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const double value = length > kNoOffence ? -0.5 * shift.dot(information * shift) : 0.0;
      if (value > best && is_possible(shift)) {
        best = value;
      }
    }
  }
  return best;
}

}  // namespace luminav
