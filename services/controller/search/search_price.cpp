#include "services/controller/search/search_price.hpp"

#include <limits>

namespace luminav {
namespace {

constexpr double kComfortable = 0.4;        // [m] less room costs more
constexpr double kNarrow = 1.5;             // metres that a metre with less room counts for
constexpr double kDoubt = 1.0;              // more metres where no alternative has room
constexpr double kMinFree = 0.3;            // share of the alternatives that must have room where no sonar looked yet
constexpr double kMinFreeIfHeard = 0.1;     // likewise where sonar found it free
constexpr double kMinFreeInNarrows = 0.35;  // likewise where sonar leaves less room than `kSearchClearance`
constexpr double kMinBesideWall = 0.35;     // share that must have room beside a wall where sonar heard something stand

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
                    const SearchMap& map) {
  constexpr double kBlocked = std::numeric_limits<double>::infinity();
  const Ground ground = map.ground_at(place);
  if (map.is_shut(place)) {
    return kBlocked;
  }
  // An echo from a door's post is drawn as wide as the beam and closes the doorway: where the alternatives have one it
  // is open until they have not.
  if (ground == Ground::kStands && chance_that(poses, [&](const PossiblePose& pose) {
                                     return forecast.is_beside_wall(pose.world_from_odom * place);
                                   }) < kMinBesideWall) {
    return kBlocked;
  }
  const double share =
      chance_that(poses, [&](const PossiblePose& pose) { return forecast.has_room(pose.world_from_odom * place); });
  const bool is_narrow = map.stands_within(place, kSearchClearance);
  const bool is_heard_free = ground == Ground::kFree && !is_narrow;
  // Sonar hears free floor also behind walls that it meets at a slant.
  if (share < (is_heard_free ? kMinFreeIfHeard : is_narrow ? kMinFreeInNarrows : kMinFree)) {
    return kBlocked;
  }
  const double doubt = is_heard_free ? 0.0 : 1.0 - share;
  return (1.0 + kDoubt * doubt) * (map.stands_within(place, kComfortable) ? kNarrow : 1.0);
}

}  // namespace luminav
