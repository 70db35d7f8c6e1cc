#include "services/controller/search/disambiguation.hpp"

#include <algorithm>
#include <cmath>

#include "services/controller/search/path_lattice.hpp"

namespace luminav {
namespace {

constexpr double kReach = 10.0;        // [m] around the robot places are looked at
constexpr double kStep = 0.2;          // [m] between the places of a path, so that doors are found
constexpr double kLook = 0.4;          // [m] between those that are looked at: what is seen from them changes slowly
constexpr int kMax = 48;               // alternatives looked at
constexpr double kFlattening = 0.5;    // power of the weights: all rivals have to go, the unlikely ones too
constexpr double kSeenAndNot = 0.55;   // what it tells when a fixture is seen that the rival has not, 1 = everything
constexpr double kMissed = 0.25;       // likewise one that the rival has and that is not there
constexpr double kWall = 1.0;          // likewise to drive where the rival has a wall
constexpr double kAnyFixture = 0.05;   // worth of a fixture that all have and none saw yet
constexpr double kMinWorth = 0.02;     // less is not worth the drive
constexpr double kHeadStart = 1.5;     // [m] added to each distance, so that a little worth close by does not win
constexpr double kFaithfulness = 2.0;  // what another place must be better than where it is heading
constexpr double kRoomAtStart = 0.4;   // [m] around it there is room, whatever the sonars heard

bool is_looked_at(const Eigen::Vector2d& place) {
  const Eigen::Array2d looks = place.array() / kLook;
  return ((looks - looks.round()).abs() < 0.25 * kStep / kLook).all();
}

}  // namespace

// Every n-th by weight, so that many alike weights are represented as fairly as few heavy ones.
std::vector<PossiblePose> Disambiguation::chosen(std::span<const PoseAlternative> alternatives) const {
  double sum = 0.0;
  for (const PoseAlternative& alternative : alternatives) {
    sum += std::pow(alternative.weight, kFlattening);
  }
  std::vector<PossiblePose> result;
  // one chosen for many stands for their chance too
  const auto look_at = [&](const PoseAlternative& alternative, double weight, double stands_for) {
    result.push_back({PointTransform(alternative.world_from_odom), alternative.world_from_odom.inverse(), weight,
                      stands_for * alternative.weight});
  };
  double passed = 0.0;
  double next = 0.5;  // in shares of 1 / most
  for (const PoseAlternative& alternative : alternatives) {
    const double share = sum > 0.0 ? std::pow(alternative.weight, kFlattening) / sum : 0.0;
    passed += share * kMax;
    if (static_cast<int>(alternatives.size()) <= kMax) {
      look_at(alternative, share, 1.0);
    } else if (passed > next) {
      const double count = std::ceil(passed - next);
      look_at(alternative, count / kMax, count / (kMax * share));
      next += count;
    }
  }
  return result;
}

// Chance that the truth, drawn by its chance, and a rival are told apart there. Once one of them is likely it is its
// own path that counts, not how its rivals might be told from each other.
double Disambiguation::worth(const Eigen::Vector2d& place, std::span<const PossiblePose> poses, const SearchMap& map,
                             std::vector<View>& views) const {
  views.clear();
  const bool is_known_floor = map.ground_at(place) == Ground::kFree;
  double with_new_fixture = 0.0;
  for (const PossiblePose& pose : poses) {
    const std::optional<PredictedView> predicted = predict(forecast_, pose, place, is_known_floor);
    if (!predicted) {
      continue;
    }
    if (predicted->fixture != nullptr) {
      // one that it passed by confirms nothing anew: a pose that is left alone waits for the next one
      with_new_fixture += map.is_near_trail(predicted->odom_from_fixture.position()) ? 0.0 : pose.weight;
    }
    auto same =
        std::find_if(views.begin(), views.end(), [&](const View& v) { return look_alike(v.predicted, *predicted); });
    if (same == views.end()) {
      same = views.insert(views.end(), {*predicted, 0.0, 0.0});
    }
    same->weight += pose.weight;
    same->chance += pose.chance * pose.urgency;
  }
  double worth = kAnyFixture * with_new_fixture;
  for (const View& truth : views) {
    for (const View& rival : views) {
      if (&truth != &rival && !truth.predicted.is_wall) {
        const double telling = rival.predicted.is_wall              ? kWall
                               : truth.predicted.fixture != nullptr ? kSeenAndNot
                                                                    : kMissed;
        worth += truth.chance * rival.weight * telling;
      }
    }
  }
  return worth;
}

double Disambiguation::price(const Eigen::Vector2d& place, const Eigen::Vector2d& started_at,
                             std::span<const PossiblePose> poses, const SearchMap& map) const {
  return (place - started_at).norm() < kRoomAtStart ? 1.0 : search_price(place, poses, forecast_, map);
}

// Dijkstra over a lattice around the robot; it ends when no farther place can be better than the best so far.
std::optional<std::vector<Eigen::Vector2d>> Disambiguation::path(const SearchPlaces& places,
                                                                 std::span<const PoseAlternative> alternatives,
                                                                 const SearchMap& map) const {
  if (forecast_.is_empty() || alternatives.empty()) {
    return std::nullopt;
  }
  std::vector<PossiblePose> poses = chosen(alternatives);
  set_urgency(poses, places.began_at, forecast_, map,
              [&](const Eigen::Vector2d& place) { return price(place, places.began_at, poses, map); });
  const double max_worth = std::max({kSeenAndNot, kMissed, kWall}) + kAnyFixture;
  PathLattice lattice(places.robot, kReach, kStep);
  double best_score = 0.0;
  int best = -1;
  std::vector<View> views;
  while (const auto visit = lattice.next()) {
    if (max_worth * kFaithfulness / (visit->distance + kHeadStart) < best_score) {
      break;
    }
    const Eigen::Vector2d here = lattice.place_of(visit->node);
    if (is_looked_at(here) && !map.is_near_trail(here)) {
      const double value = worth(here, poses, map, views);
      const bool is_where_it_heads = places.heading_for && (here - *places.heading_for).norm() < 2.0 * kStep;
      const double score = value * (is_where_it_heads ? kFaithfulness : 1.0) / (visit->distance + kHeadStart);
      if (value > kMinWorth && score > best_score) {
        best_score = score;
        best = visit->node;
      }
    }
    lattice.expand(*visit, [&](const Eigen::Vector2d& there) { return price(there, places.robot, poses, map); });
  }
  return best < 0 ? std::nullopt : std::optional(lattice.path_to(best));
}

}  // namespace luminav
