#pragma once

#include <array>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline/outline.hpp"

namespace luminav {

/// What the grid lines of the ceiling that run across a strip's direction say about what lies right beside it.
enum class Beside {
  kUnknown,  // no line to be seen, or too little in view
  kCeiling,  // the lines go on up to the strip
  kCovered,  // they end a strip's width away from it
};

/// Of the strip's left (its +y) and right side. A line between tiles goes on beneath a lamp and shows on both sides of
/// it; the dark half of a fixture of two lamps covers it. The lines in a band beside the strip, where its dark half
/// would be, are compared with those in the other bands: over there and farther out, at the same places along it.
std::array<Beside, 2> look_for_grid_lines(const GreyView& image, const CeilingCamera& camera, const Outline& strip,
                                          const OutlinePlacement& placement, double pixel_noise);

}  // namespace luminav
