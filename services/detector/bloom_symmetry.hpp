#pragma once

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline.hpp"
#include "services/detector/outline_fit.hpp"

namespace luminav {

/// Moves a lit outline to where the light around it falls off alike on opposite sides. One level of the bloom says
/// where it ends only on an even ceiling; here the whole fall of the light is compared, a robust regression of the
/// difference between opposite sides on the slope of their mean, so that a joint or anything else beside one side is an
/// outlier. Sides that are not both in view keep their place, and round outlines theirs; so do ends in view whose
/// difference is not explained, with a covariance that says so.
void balance_bloom(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
                   const OutlineFitParams& params, OutlineFit& fit);

}  // namespace luminav
