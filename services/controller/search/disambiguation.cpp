#include "services/controller/search/disambiguation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/controller/search/path_lattice.hpp"

namespace luminav {
// Every n-th by weight, so that many alike weights are represented as fairly as few heavy ones.
std::vector<PossiblePose> Disambiguation::chosen(std::span<const PoseAlternative> alternatives) const {
  double sum = 0.0;
  for (const PoseAlternative& alternative : alternatives) {
    sum += std::pow(alternative.weight, params_.flattening);
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
    const double share = sum > 0.0 ? std::pow(alternative.weight, params_.flattening) / sum : 0.0;
    passed += share * params_.max;
    if (static_cast<int>(alternatives.size()) <= params_.max) {
      look_at(alternative, share, 1.0);
    } else if (passed > next) {
      const double count = std::ceil(passed - next);
      look_at(alternative, count / params_.max, count / (params_.max * share));
      next += count;
    }
  }
  return result;
}

// Chance that the truth, drawn by its chance, and a rival are told apart there. Once one of them is likely it is its
// own way that counts, not how its rivals might be told from each other.
double Disambiguation::worth(const Eigen::Vector2d& place, std::span<const PossiblePose> poses, const SearchMap& map,
                             std::vector<View>& views) const {
  views.clear();
  const bool is_known_floor = map.ground_at(place) == Ground::kFree;
  double with_new_fixture = 0.0;
  for (const PossiblePose& pose : poses) {
    const std::optional<PredictedView> predicted = predict(forecast_, pose, place, is_known_floor, params_.views);
    if (!predicted) {
      continue;
    }
    if (predicted->fixture != nullptr) {
      // one that it passed by confirms nothing anew: a pose that is left alone waits for the next one
      with_new_fixture += map.is_near_trail(predicted->odom_from_fixture.position()) ? 0.0 : pose.weight;
    }
    auto same = std::find_if(views.begin(), views.end(),
                             [&](const View& v) { return look_alike(v.predicted, *predicted, params_.views); });
    if (same == views.end()) {
      same = views.insert(views.end(), {*predicted, 0.0, 0.0});
    }
    same->weight += pose.weight;
    same->chance += pose.chance * pose.urgency;
  }
  double worth = params_.any_fixture * with_new_fixture;
  for (const View& truth : views) {
    for (const View& rival : views) {
      if (&truth != &rival && !truth.predicted.is_wall) {
        const double telling = rival.predicted.is_wall              ? params_.wall
                               : truth.predicted.fixture != nullptr ? params_.seen_and_not
                                                                    : params_.missed;
        worth += truth.chance * rival.weight * telling;
      }
    }
  }
  return worth;
}

double Disambiguation::price(const Eigen::Vector2d& place, const Eigen::Vector2d& started_at,
                             std::span<const PossiblePose> poses, const SearchMap& map) const {
  return (place - started_at).norm() < params_.room_at_start
             ? 1.0
             : search_price(place, poses, forecast_, map, params_.price);
}

// Dijkstra over a lattice around the robot; it ends when no farther place can be better than the best so far.
std::optional<std::vector<Eigen::Vector2d>> Disambiguation::path(const SearchPlaces& places,
                                                                 std::span<const PoseAlternative> alternatives,
                                                                 const SearchMap& map) const {
  if (forecast_.is_empty() || alternatives.empty()) {
    return std::nullopt;
  }
  std::vector<PossiblePose> poses = chosen(alternatives);
  set_urgency(
      poses, places.began_at, forecast_, map, params_.views,
      [&](const Eigen::Vector2d& place) { return price(place, places.began_at, poses, map); }, params_.urgency);
  const double max_worth = std::max({params_.seen_and_not, params_.missed, params_.wall}) + params_.any_fixture;
  PathLattice lattice(places.robot, params_.reach, params_.step);
  double best_score = 0.0;
  int best = -1;
  std::vector<View> views;
  while (const auto visit = lattice.next()) {
    if (max_worth * params_.faithfulness / (visit->distance + params_.head_start) < best_score) {
      break;
    }
    const Eigen::Vector2d here = lattice.place_of(visit->node);
    if (!map.is_near_trail(here)) {
      const double value = worth(here, poses, map, views);
      const bool is_where_it_heads = places.heading_for && (here - *places.heading_for).norm() < 2.0 * params_.step;
      const double score =
          value * (is_where_it_heads ? params_.faithfulness : 1.0) / (visit->distance + params_.head_start);
      if (value > params_.min_worth && score > best_score) {
        best_score = score;
        best = visit->node;
      }
    }
    lattice.expand(*visit, [&](const Eigen::Vector2d& there) { return price(there, places.robot, poses, map); });
  }
  return best < 0 ? std::nullopt : std::optional(lattice.path_to(best));
}

}  // namespace luminav
