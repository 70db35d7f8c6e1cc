#pragma once

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline_fit.hpp"

namespace luminav {

inline constexpr int kBloomSearch = 6;  // [px] to each side of the edge that the fit found

/// Moves the outline of a lit fixture to where its bloom falls to the same height above the ceiling on all sides.
///
/// A lamp saturates the sensor, and so does the bloom next to it: the fixture's own edge does not show, the edge that
/// does show lies where the sum of bloom and ceiling leaves saturation, and so is pushed outward on a brighter side.
/// The bloom alone is the same all round. Each side's ceiling is taken from beyond its bloom, carried to the edge by
/// the slope between opposite sides. Along a fixture that is cut it may change: where a corner of the image leaves
/// different stretches of the long sides in view, that would turn the outline. Changes pose, swelling, residual and
/// covariance; leaves the fit as it is when too few edge points are found, and round outlines always.
void level_bloom(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
                 const OutlineFitParams& params, OutlineFit& fit);

}  // namespace luminav
