#pragma once

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline.hpp"
#include "services/detector/outline_fit.hpp"

namespace luminav {

/// Moves the outline of an unlit fixture to where the grey levels across its opposite sides place it best, its size
/// being known. A joint of the ceiling beside a side is as dark as the fixture and hides where that side ends, but it
/// goes on beyond the fixture's corners and shows there: what is left of it beside the side is compared with that.
/// Changes place and covariance.
void take_off_joints(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
                     const OutlineFitParams& params, OutlineFit& fit);

/// Moves a fixture of which one half burns across, to where the long side of its dark half is seen: that has no bloom,
/// the other one's moves an outline fitted to both. `seen` is the fit to the edges as they are. Changes place and
/// covariance, which says how far it may be off where the dark side is not in view.
void place_by_dark_half(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
                        const OutlineFitParams& params, const OutlineFit& seen, Side dark_side, OutlineFit& fit);

}  // namespace luminav
