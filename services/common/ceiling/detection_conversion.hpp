#pragma once

#include <Eigen/Core>
#include <luminav/fixture_detections_t.hpp>

#include "services/common/ceiling/fixture_sighting.hpp"

namespace luminav {

/// Finite, with positive variances.
bool is_covariance(const double (&values)[9]);
Eigen::Matrix3d to_matrix(const double (&values)[9]);

/// False for a detection that no image can show: not a number, of no size, tens of metres away.
bool is_possible(const fixture_detection_t& detection);
FixtureSighting to_sighting(const fixture_detection_t& detection);
/// The fixtures among what an image shows, at its stamp; what cannot be is left out.
SightingFrame to_frame(const fixture_detections_t& message);

}  // namespace luminav
