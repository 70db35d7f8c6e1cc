#pragma once

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline_fit.hpp"

namespace luminav {

/// True when what lies inside of an outline, as far as it is in view, is surely smooth: no stripes across or along it,
/// as the slats of a vent would make, clearly fainter ones than its own edges are high. False also where noise or too
/// small a piece leave that open.
bool is_surely_smooth(const GreyView& image, const CeilingCamera& camera, const Outline& outline, const OutlineFit& fit,
                      double pixel_noise);

}  // namespace luminav
