#pragma once

#include <optional>

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline/outline.hpp"

namespace luminav {

// On which side of a lit strip lie lamps of its fixture that do not burn: 1 on its left (its +y), -1 on its right, 0
// where neither side shows any, or both.

/// By brightness: light falls off outwards, so what is darker within `dark_width` [m] of a lamp than beyond is the dark
/// part of its fixture. Nothing where a side is out of view and the other one is not darker.
std::optional<int> find_darker_side(const GreyView& image, const CeilingCamera& camera, const Outline& strip,
                                    const OutlinePlacement& placement, double dark_width, double pixel_noise);

/// By the grid of the ceiling: a line between tiles goes on beneath a lamp and shows on both sides of it; the dark half
/// of a fixture of two lamps covers it. The lines in a band beside the strip, where its dark half would be, are
/// compared with those in the other bands: over there and farther out, at the same places along it.
int find_covered_side(const GreyView& image, const CeilingCamera& camera, const Outline& strip,
                      const OutlinePlacement& placement, double pixel_noise);

}  // namespace luminav
