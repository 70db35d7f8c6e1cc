#pragma once

#include "services/common/building/building.hpp"
#include "services/common/geometry/camera_model.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/common/image/grey_image.hpp"

namespace luminav::score {

/// What a person needs to see an edge of some 0.1 m at a glance: a step of 6 grey levels between what lies on both
/// sides of it, along half of the outline.
constexpr double kSeenStep = 6.0;   // [grey]
constexpr double kSeenShare = 0.5;  // of the outline in the image

/// Share of a fixture's outline in the image along which what is just inside differs by `kSeenStep` from what is just
/// outside, each the mean of a patch of 0.1 m by 25 mm; 0 where none of it is in the image.
double seen_share(const GreyView& image, const CeilingCamera& camera, const Fixture& fixture,
                  const Pose2& robot_from_fixture);

}  // namespace luminav::score
