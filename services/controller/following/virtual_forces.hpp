#pragma once

#include <Eigen/Core>

#include "services/common/geometry/angle.hpp"
#include "services/controller/safety/obstacles.hpp"

namespace luminav {

struct VirtualForceParams {
  double influence = 0.45;  // [m] from the outline; farther obstacles do not push
  double strength = 1.4;    // push of one direction at contact, in pulls of the goal
  double max = 0.75;        // of the sum, in pulls of the goal: below 1 the goal always wins
};

/// Attraction and repulsion, robot frame, unit 1 = the pull of the temporary goal.
struct VirtualForce {
  Eigen::Vector2d attractive = Eigen::Vector2d::Zero();
  Eigen::Vector2d repulsive = Eigen::Vector2d::Zero();
  [[nodiscard]] Eigen::Vector2d resultant() const { return attractive + repulsive; }
};

/// The goal pulls with 1; in each of 24 directions the nearest obstacle pushes, quadratically more the nearer it is to
/// the outline. One push per direction, so that a wall of many cells does not outweigh a post. Borenstein and Koren
/// 1989.
VirtualForce virtual_force(const Eigen::Vector2d& goal_in_robot, const Obstacles& obstacles,
                           const VirtualForceParams& params);

}  // namespace luminav
