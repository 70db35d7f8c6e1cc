#include "services/controller/virtual_forces.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace luminav {
namespace {

constexpr int kDirections = 24;

}  // namespace

VirtualForce virtual_force(const Eigen::Vector2d& goal_in_robot, std::span<const ObstaclePoint> obstacles,
                           const Footprint& footprint, const VirtualForceParams& params) {
  struct Push {
    double clearance = 1e9;  // [m]
    Eigen::Vector2d towards = Eigen::Vector2d::Zero();
  };
  std::array<Push, kDirections> pushes{};
  const double reach = footprint.swept_radius() + params.influence;
  const double surely_outside = (1.0 + 1e-12) * reach * reach;
  for (const ObstaclePoint& obstacle : obstacles) {
    if (obstacle.position.squaredNorm() > surely_outside ||
        footprint.is_surely_beyond(obstacle.position, params.influence)) {
      continue;  // it would push with nothing
    }
    const double distance = obstacle.position.norm();
    if (distance > reach || distance < 1e-6) {
      continue;
    }
    const double direction = std::atan2(obstacle.position.y(), obstacle.position.x());
    if (std::abs(direction) > params.blind_behind) {
      continue;
    }
    const auto index = static_cast<std::size_t>((direction + kPi) / (2.0 * kPi) * kDirections) % kDirections;
    const double clearance = std::max(0.0, footprint.distance(obstacle.position));
    if (clearance < pushes[index].clearance) {
      pushes[index] = {clearance, obstacle.position / distance};
    }
  }
  VirtualForce force;
  const double pull = goal_in_robot.norm();
  if (pull > 1e-6) {
    force.attractive = goal_in_robot / pull;
  }
  for (const Push& push : pushes) {
    if (push.clearance < params.influence) {
      const double nearness = 1.0 - push.clearance / params.influence;
      force.repulsive -= params.strength * nearness * nearness * push.towards;
    }
  }
  const double size = force.repulsive.norm();
  if (size > params.most) {
    force.repulsive *= params.most / size;
  }
  return force;
}

}  // namespace luminav
