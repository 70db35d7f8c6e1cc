#pragma once

#include "services/common/geometry/camera_model.hpp"
#include "services/common/image/grey_image.hpp"
#include "services/detector/outline.hpp"
#include "services/detector/outline_fit.hpp"

namespace luminav {

/// Moves the outline of an unlit fixture off the joints of the ceiling that it was fitted to. A joint beside a side is
/// as dark as the fixture and hides where that side ends, but it goes on beyond the fixture's corners and shows there.
/// Then the opposite side alone says where the fixture is, its size being known; or, where a joint hides there too,
/// what each side leaves of its own. Changes place and covariance.
void take_off_joints(const GreyView& image, const CeilingCamera& camera, const Outline& outline,
                     const OutlineFitParams& params, OutlineFit& fit);

}  // namespace luminav
