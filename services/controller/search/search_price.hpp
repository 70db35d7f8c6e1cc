#pragma once

#include <Eigen/Core>
#include <span>

#include "services/controller/search/ceiling_forecast.hpp"
#include "services/controller/search/predicted_view.hpp"
#include "services/controller/search/search_map.hpp"

namespace luminav {

struct SearchPriceParams {
  double clearance = 0.2;             // [m] least room that sonar must leave
  double comfortable = 0.4;           // [m] less room costs more
  double narrow = 1.5;                // metres that a metre with less room counts for
  double doubt = 1.0;                 // more metres where no alternative has room
  double min_free = 0.3;              // share of the alternatives that must have room where no sonar looked yet
  double min_free_if_heard = 0.1;     // likewise where sonar found it free
  double min_free_in_narrows = 0.35;  // likewise where sonar leaves less room than `clearance`
  double min_beside_wall = 0.35;      // share that must have room beside a wall where sonar heard something stand
};

/// Price of a metre at a place [m, odom] while searching for the pose; infinite if no path leads through.
/// Floor that sonar knows counts as it is if any likely alternative has room there, the rest by what their walls say.
[[nodiscard]] double search_price(const Eigen::Vector2d& place, std::span<const PossiblePose> poses,
                                  const CeilingForecast& forecast, const SearchMap& map,
                                  const SearchPriceParams& params);

}  // namespace luminav
