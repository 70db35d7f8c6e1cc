#pragma once

#include <Eigen/Core>
#include <span>

#include "services/localizer/pose_belief.hpp"
#include "services/localizer/wall_field.hpp"

namespace luminav {

/// One echo of a disc: where the disc is and where the middle of its beam ended, in the robot frame.
struct PlacedEcho {
  Eigen::Vector2d disc;
  Eigen::Vector2d end;
  double range = 0.0;   // [m] between the two
  double weight = 1.0;  // as evidence: what is heard of a surface again tells less
};

/// Units of work, see WorkBudget, that one echo takes.
inline constexpr int kUnitsPerEcho = 2;

/// Log of the likelihood ratio of echoes under a pose against echoes from anything: near the first wall that the beam
/// meets in the map, or from behind it. `half_angle` [rad] of the sonar's beam.
double log_likelihood_of_echoes(const PoseBelief& belief, std::span<const PlacedEcho> echoes, const WallField& walls,
                                double half_angle);

}  // namespace luminav
