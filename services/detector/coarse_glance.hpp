#pragma once

#include "services/common/geometry/camera_model.hpp"
#include "services/common/geometry/pose2.hpp"
#include "services/detector/candidate.hpp"
#include "services/detector/outline.hpp"

namespace luminav {

/// False when a long side of a guessed outline shows no edge in the reduced image: then the fit, which averages over
/// many pixels to see faint edges, would find none either. A cell is such an average already, so a look costs a tenth.
/// True where the reduced image cannot tell: too little in view, cells too small to average much, or a disc.
/// `least_step` [grey] that an edge must have from outside to inside: below 0 for what is darker.
bool may_have_long_sides(const CeilingFrame& frame, const CeilingCamera& camera, const Outline& outline,
                         const Pose2& start, double least_step);

}  // namespace luminav
