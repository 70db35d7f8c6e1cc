#pragma once

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline/outline.hpp"

namespace luminav {

/// What lies beside a lit strip, left against right.
struct StripSurroundings {
  bool valid = false;      // enough of both sides is in view
  double asymmetry = 0.0;  // share of the distances at which the sides differ by more than shading explains
  int side = 0;  // +1: something of the strip's width joins on the left (its +y), -1: on the right, 0: unclear
};

/// Returns the side of a lit strip, +1 for its left and -1 for its right, on which it is darker within `dark_width` [m]
/// than beyond: light falls off outwards, so what is darker near a lamp is the dark part of its fixture. 0 where
/// neither side is, or both.
int find_darker_side(const GreyView& image, const CeilingCamera& camera, const Outline& strip,
                     const OutlinePlacement& placement, double dark_width, double pixel_noise);

/// Bloom and halo of a fixture that burns as a whole are the same on both sides; beside the burning half of a fixture
/// of two lamps lies its dark half on one side and the ceiling on the other. Compares the brightness at equal distances
/// from the strip, medians along it; a slope is allowed for, and a grid line of the ceiling is too thin to matter.
StripSurroundings compare_strip_sides(const GreyView& image, const CeilingCamera& camera, const Outline& strip,
                                      const OutlinePlacement& placement, double pixel_noise);

}  // namespace luminav
