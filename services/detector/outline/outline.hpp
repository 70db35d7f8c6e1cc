#pragma once

#include "services/common/building/building.hpp"
#include "services/common/geometry/pose2.hpp"

namespace luminav {

/// Shape on a horizontal plane whose edges are looked for in the image.
struct Outline {
  FixtureShape shape = FixtureShape::kRectangle;
  double length = 1.2;  // [m] along x of the outline
  double width = 0.3;   // [m] along y
  double height = 2.8;  // [m] above the floor
};

/// Sides of an outline: two long ones, then the ends. A round outline has the first only.
enum Side { kLeftSide, kRightSide, kFarEnd, kNearEnd, kSides };

/// Where an outline lies, and by how much it looks larger than its nominal size: light widens it, and sizes and
/// heights are known to some per cent only.
struct OutlinePlacement {
  Pose2 pose;                // robot_from_outline
  double side_outset = 0.0;  // [m] by which the long sides, or the circle, lie farther out
  double end_outset = 0.0;   // [m] the ends
};

}  // namespace luminav
