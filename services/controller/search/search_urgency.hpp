#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "services/controller/search/ceiling_forecast.hpp"
#include "services/controller/search/predicted_view.hpp"
#include "services/controller/search/search_map.hpp"

namespace luminav {

/// Sets each pose's urgency by how short its path from where the search began [m, odom] is to where it is told from its
/// rivals. A search that goes on along a corridor finds many poses quickly and lets the few wait that a look the other
/// way would have found at once: no path shall be many times longer than it need be. On average it is 1, weighted by
/// chance. `price`: metres that a metre at a place counts for.
void set_urgency(std::vector<PossiblePose>& poses, const Eigen::Vector2d& began_at, const CeilingForecast& forecast,
                 const SearchMap& map, const std::function<double(const Eigen::Vector2d&)>& price);

}  // namespace luminav
