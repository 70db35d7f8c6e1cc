#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/common/ceiling/fixture_map.hpp"
#include "services/common/ceiling/fixture_sighting.hpp"
#include "services/localizer/tracking/tracking_filter.hpp"

namespace luminav {

/// By how much a fixture may stand beside its place and still be that fixture: 60 mm and 1.5 degrees. [m^2, m^2, rad^2]
inline const Eigen::Vector3d kFixtureSurprise{0.0036, 0.0036, 0.0007};

inline constexpr double kMatchGate = 16.27;  ///< of the normalised innovation squared: chi2(3) at 99.9 %

/// Which sighting is which fixture, one to one and the best pairs first, for a pose as well known as the filter's.
std::vector<FixtureMatch> match_sightings(const TrackingFilter& filter, const FixtureMap& map,
                                          const SightingFrame& frame, const OdometryReading& odometry);

}  // namespace luminav
