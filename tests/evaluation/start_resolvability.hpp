#pragma once

#include <Eigen/Core>

#include "services/common/building/building.hpp"
#include "services/common/configuration/robot_file.hpp"

namespace luminav {

/// Way [m] that a robot must drive from a start at least until the ceiling tells its pose, as scripts/audit has it:
/// straight to where its last twin is refuted, whatever its heading. Infinite: never; negative: not known, for a floor
/// of more than a thousand fixtures or a start outside of the places looked at.
[[nodiscard]] double resolvable_way(const Building& building, const CameraDescription& camera,
                                    const Eigen::Vector2d& start);

}  // namespace luminav
