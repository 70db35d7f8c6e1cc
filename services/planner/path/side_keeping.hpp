#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "services/planner/space/configuration_space.hpp"

namespace luminav {

using Polyline = std::vector<Eigen::Vector2d>;  // [m] world

/// Of a corridor, as seen by who drives along it.
enum class KeepSide { kNone, kRight, kLeft };

/// "none", "right" or "left", as robot files spell it.
inline KeepSide side_called(std::string_view word) {
  return word == "right" ? KeepSide::kRight : word == "left" ? KeepSide::kLeft : KeepSide::kNone;
}

/// How far [m] from a path its room is looked at.
inline constexpr double kSideReach = 4.0;

/// Moves a shaped path of evenly spaced points towards one side of the corridors: where two can pass to a sixth of the
/// room that the robot's middle has there, and less where it is narrower, or where a door or a thing narrows it. The
/// ends stay, what is clear stays clear, and no path becomes more than 5 % longer: one that would keeps half as far to
/// the side.
Polyline keep_to_side(const ConfigurationSpace& space, KeepSide side, const Polyline& path);

}  // namespace luminav
