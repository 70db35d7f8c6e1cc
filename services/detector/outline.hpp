#pragma once

#include "services/common/building/building.hpp"

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

struct OutlineFitParams {
  bool inside_brighter = true;
  double least_edge = 10.0;        // [grey] step that counts as an edge
  double expected_step = 100.0;    // [grey] about what it should be: fainter ones are averaged over longer stretches
  double pixel_noise = 4.0;        // [grey] 1 sigma
  double first_swelling = 0.0;     // [m] where the search begins
  double swelling_sigma = 0.01;    // [m] how much wider than it is the outline may look, 1 sigma
  double taper_sigma = 0.01;       // [m/m] change of the swelling along the outline: bloom where the light differs
  double edge_sigma_px = 0.15;     // [px] least error of one edge point
  double outline_sigma_px = 0.06;  // [px] error that the points of a side share
  double vignetting = 0.3;         // share of the light that is lost in the image's corners
  int first_search_px = 11;        // [px] to each side of the start
};

}  // namespace luminav
