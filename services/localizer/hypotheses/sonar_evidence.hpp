#pragma once

#include <Eigen/Core>
#include <span>

#include "services/localizer/model/pose_belief.hpp"
#include "services/localizer/model/wall_field.hpp"

namespace luminav {

/// One beam of a disc: where the disc is and where the beam's middle ended, in the robot frame: at an echo, or silent
/// as far as walls are surely heard.
struct PlacedEcho {
  Eigen::Vector2d disc;
  Eigen::Vector2d end;
  double range = 0.0;           // [m] between the two
  double weight = 1.0;          // as evidence of what echoed, 0 of a silent beam; of a surface heard again it is less
  double passage_weight = 0.0;  // as evidence that no wall faces the disc on the way to the end
};

/// Units of work, see WorkBudget, that one echo takes.
inline constexpr int kUnitsPerEcho = 2;

/// Log of the likelihood ratio of beams under a pose against beams anywhere: an echo from near the first wall that the
/// beam meets in the map, or from behind it; no echo of a wall that faces the disc. Things on no map add echoes and may
/// so speak for a wrong pose, but they silence no wall: what passes through one speaks louder. `half_angle` [rad] of
/// the sonar's beam.
double log_likelihood_of_echoes(const PoseBelief& belief, std::span<const PlacedEcho> echoes, const WallField& walls,
                                double half_angle);

}  // namespace luminav
