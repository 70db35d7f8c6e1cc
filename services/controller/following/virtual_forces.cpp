#include "services/controller/following/virtual_forces.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace luminav {
namespace {

constexpr double kBlindBehind = 2.0;  // [rad] obstacles farther off the course do not push

constexpr int kDirections = 24;

}  // namespace

VirtualForce virtual_force(const Eigen::Vector2d& goal_in_robot, const Obstacles& obstacles,
                           const VirtualForceParams& params) {
  struct Push {
    double clearance = 1e9;  // [m]
    Eigen::Vector2d towards = Eigen::Vector2d::Zero();
  };
  std::array<Push, kDirections> pushes{};
  const Footprint& footprint = obstacles.footprint();
  const double reach = footprint.swept_radius() + params.influence;
  obstacles.visit_within(params.influence, [&](std::size_t i) {
    const Eigen::Vector2d position = obstacles.points()[i].position;
    const double distance = position.norm();
    if (distance > reach || distance < 1e-6) {
      return;
    }
    const double direction = std::atan2(position.y(), position.x());
    if (std::abs(direction) > kBlindBehind) {
      return;
    }
    const auto index = static_cast<std::size_t>((direction + kPi) / (2.0 * kPi) * kDirections) % kDirections;
    const double clearance = std::max(0.0, footprint.distance(position));
    if (clearance < pushes[index].clearance) {
      pushes[index] = {clearance, position / distance};
    }
  });
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
  if (size > params.max) {
    force.repulsive *= params.max / size;
  }
  return force;
}

}  // namespace luminav
