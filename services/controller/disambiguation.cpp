#include "services/controller/disambiguation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/controller/way_lattice.hpp"

namespace luminav {
// Every n-th by weight, so that many alike weights are represented as fairly as few heavy ones.
std::vector<Disambiguation::LookedAt> Disambiguation::chosen(std::span<const PoseAlternative> alternatives) const {
  double sum = 0.0;
  for (const PoseAlternative& alternative : alternatives) {
    sum += std::pow(alternative.weight, params_.flattening);
  }
  std::vector<LookedAt> result;
  // one chosen for many stands for their chance too
  const auto look_at = [&](const PoseAlternative& alternative, double weight, double stands_for) {
    result.push_back({PointTransform(alternative.world_from_odom), alternative.world_from_odom.inverse(), weight,
                      stands_for * alternative.weight});
  };
  double passed = 0.0;
  double next = 0.5;  // in shares of 1 / most
  for (const PoseAlternative& alternative : alternatives) {
    const double share = sum > 0.0 ? std::pow(alternative.weight, params_.flattening) / sum : 0.0;
    passed += share * params_.most;
    if (static_cast<int>(alternatives.size()) <= params_.most) {
      look_at(alternative, share, 1.0);
    } else if (passed > next) {
      const double count = std::ceil(passed - next);
      look_at(alternative, count / params_.most, count / (params_.most * share));
      next += count;
    }
  }
  return result;
}

double Disambiguation::free_share(const Eigen::Vector2d& place, std::span<const LookedAt> alternatives) const {
  double with_room = 0.0;
  double sum = 0.0;
  for (const LookedAt& alternative : alternatives) {
    with_room += forecast_.has_room(alternative.world_from_odom * place) ? alternative.chance : 0.0;
    sum += alternative.chance;
  }
  return sum > 0.0 ? with_room / sum : 0.0;
}

bool Disambiguation::look_alike(const View& a, const View& b) const {
  if (a.is_wall || b.is_wall || a.fixture == nullptr || b.fixture == nullptr) {
    return a.is_wall == b.is_wall && a.fixture == b.fixture;
  }
  const double period = symmetry_period(a.fixture->shape);
  const double turn = wrap_angle(a.odom_from_fixture.theta - b.odom_from_fixture.theta);
  return a.fixture->shape == b.fixture->shape && std::abs(a.fixture->length - b.fixture->length) < 0.1 &&
         distance(a.odom_from_fixture, b.odom_from_fixture) < params_.same_place &&
         (period == 0.0 || std::abs(std::remainder(turn, period)) < params_.same_axis);
}

// Chance that the truth, drawn by its chance, and a rival are told apart there. Once one of them is likely it is its
// own way that counts, not how its rivals might be told from each other.
double Disambiguation::worth(const Eigen::Vector2d& place, std::span<const LookedAt> alternatives, const SearchMap& map,
                             std::vector<View>& views) const {
  views.clear();
  const bool is_known_floor = map.ground_at(place) == Ground::kFree;
  double with_new_fixture = 0.0;
  for (const LookedAt& alternative : alternatives) {
    const Eigen::Vector2d there = alternative.world_from_odom * place;
    View view;
    view.weight = alternative.weight;
    view.chance = alternative.chance;
    view.is_wall = !is_known_floor && !forecast_.has_room(there);
    view.fixture = view.is_wall ? nullptr : forecast_.fixture_above(there);
    if (view.fixture != nullptr) {
      view.odom_from_fixture = alternative.odom_from_world * view.fixture->world_from_fixture;
      if ((view.fixture->world_from_fixture.position() - there).norm() >
          params_.sure_within * forecast_.view_radius()) {
        continue;  // at the border of the image: it may be seen or not
      }
      // one that it passed by confirms nothing anew: a pose that is left alone waits for the next one
      with_new_fixture += map.is_near_trail(view.odom_from_fixture.position()) ? 0.0 : view.weight;
    }
    const auto same = std::find_if(views.begin(), views.end(), [&](const View& v) { return look_alike(v, view); });
    if (same != views.end()) {
      same->weight += view.weight;
      same->chance += view.chance;
    } else {
      views.push_back(view);
    }
  }
  double worth = params_.any_fixture * with_new_fixture;
  for (const View& truth : views) {
    for (const View& rival : views) {
      if (&truth != &rival && !truth.is_wall) {
        const double telling = rival.is_wall              ? params_.wall
                               : truth.fixture != nullptr ? params_.seen_and_not
                                                          : params_.missed;
        worth += truth.chance * rival.weight * telling;
      }
    }
  }
  return worth;
}

double Disambiguation::price(const Eigen::Vector2d& place, std::span<const LookedAt> alternatives,
                             const SearchMap& map) const {
  const Ground ground = map.ground_at(place);
  if (ground == Ground::kStands) {
    return std::numeric_limits<double>::infinity();
  }
  const bool is_narrow = map.stands_within(place, params_.clearance);
  const bool is_heard_free = ground == Ground::kFree && !is_narrow;
  const double share = free_share(place, alternatives);
  // Echoes from door posts close doorways: where the alternatives have one it is open until they have not. And sonar
  // hears free floor behind walls that it meets at a slant.
  if (share < (is_heard_free ? params_.least_free_if_heard
               : is_narrow   ? params_.least_free_in_narrows
                             : params_.least_free)) {
    return std::numeric_limits<double>::infinity();
  }
  const double doubt = is_heard_free ? 0.0 : 1.0 - share;
  const double narrowness = is_narrow ? 4.0 : map.stands_within(place, params_.comfortable) ? 2.0 : 1.0;
  return (1.0 + 2.0 * doubt) * narrowness;
}

// Dijkstra over a lattice around the robot; it ends when no farther place can be better than the best so far.
std::optional<std::vector<Eigen::Vector2d>> Disambiguation::way(
    const Eigen::Vector2d& place, std::span<const PoseAlternative> alternatives, const SearchMap& map,
    const std::optional<Eigen::Vector2d>& heading_for) const {
  if (forecast_.is_empty() || alternatives.empty()) {
    return std::nullopt;
  }
  const std::vector<LookedAt> looked_at = chosen(alternatives);
  WayLattice lattice(place, params_.reach, params_.step);
  const double most_worth = std::max({params_.seen_and_not, params_.missed, params_.wall}) + params_.any_fixture;
  double best_score = 0.0;
  int best = -1;
  std::vector<View> views;
  while (const auto visit = lattice.next()) {
    if (most_worth * params_.faithfulness / (visit->way + params_.head_start) < best_score) {
      break;
    }
    const Eigen::Vector2d here = lattice.place_of(visit->node);
    if (!map.is_near_trail(here)) {
      const double value = worth(here, looked_at, map, views);
      const bool is_where_it_heads = heading_for && (here - *heading_for).norm() < 2.0 * params_.step;
      const double score = value * (is_where_it_heads ? params_.faithfulness : 1.0) / (visit->way + params_.head_start);
      if (value > params_.least_worth && score > best_score) {
        best_score = score;
        best = visit->node;
      }
    }
    lattice.expand(*visit, [&](const Eigen::Vector2d& there) {
      // where it stands there is room, whatever the sonars heard
      return (there - place).norm() < params_.comfortable ? 1.0 : price(there, looked_at, map);
    });
  }
  return best < 0 ? std::nullopt : std::optional(lattice.way_to(best));
}

}  // namespace luminav
