#include "services/controller/search/search_price.hpp"

#include <limits>

namespace luminav {
namespace {

/// Chance that the truth is a pose of which something is true.
template <typename Predicate>
double chance_that(std::span<const PossiblePose> poses, const Predicate& is_true) {
  double chance = 0.0;
  double sum = 0.0;
  for (const PossiblePose& pose : poses) {
    chance += is_true(pose) ? pose.chance : 0.0;
    sum += pose.chance;
  }
  return sum > 0.0 ? chance / sum : 0.0;
}

}  // namespace

double search_price(const Eigen::Vector2d& place, std::span<const PossiblePose> poses, const CeilingForecast& forecast,
                    const SearchMap& map, const SearchPriceParams& params) {
  constexpr double kBlocked = std::numeric_limits<double>::infinity();
  const Ground ground = map.ground_at(place);
  if (map.is_shut(place)) {
    return kBlocked;
  }
  // An echo from a door's post is drawn as wide as the beam and closes the doorway: where the alternatives have one it
  // is open until they have not.
  if (ground == Ground::kStands && chance_that(poses, [&](const PossiblePose& pose) {
                                     return forecast.is_beside_wall(pose.world_from_odom * place);
                                   }) < params.min_beside_wall) {
    return kBlocked;
  }
  const double share =
      chance_that(poses, [&](const PossiblePose& pose) { return forecast.has_room(pose.world_from_odom * place); });
  const bool is_narrow = map.stands_within(place, params.clearance);
  const bool is_heard_free = ground == Ground::kFree && !is_narrow;
  // Sonar hears free floor also behind walls that it meets at a slant.
  if (share < (is_heard_free ? params.min_free_if_heard : is_narrow ? params.min_free_in_narrows : params.min_free)) {
    return kBlocked;
  }
  const double doubt = is_heard_free ? 0.0 : 1.0 - share;
  return (1.0 + params.doubt * doubt) * (map.stands_within(place, params.comfortable) ? params.narrow : 1.0);
}

}  // namespace luminav
