#pragma once

#include <Eigen/Core>
#include <span>

#include "services/controller/search/ceiling_forecast.hpp"
#include "services/controller/search/predicted_view.hpp"
#include "services/controller/search/search_map.hpp"

namespace luminav {

/// Least room [m] that sonar must leave to either side of the robot's middle.
inline constexpr double kSearchClearance = 0.2;

/// Price of a metre at a place [m, odom] while searching for the pose; infinite if no path leads through.
/// Floor that sonar knows counts as it is if any likely alternative has room there, the rest by what their walls say.
[[nodiscard]] double search_price(const Eigen::Vector2d& place, std::span<const PossiblePose> poses,
                                  const CeilingForecast& forecast, const SearchMap& map);

}  // namespace luminav
