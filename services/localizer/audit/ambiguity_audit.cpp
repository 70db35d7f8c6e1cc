#include "services/localizer/audit/ambiguity_audit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <set>
#include <tuple>

#include "services/common/ceiling/ceiling_view.hpp"

namespace luminav {
namespace {

constexpr int kElementLamps = 1000;         // lamps of a fixture that stands for an element: its kind is added
constexpr std::size_t kMaxCandidates = 40;  // fixtures whose change is tried: those that the motions mix up most
constexpr std::size_t kMaxForChanges = 40;  // motions that a change is tried on: those that cost most
constexpr std::size_t kMinRivals = 64;      // kept at a place: those that are refuted last ...
constexpr std::size_t kMaxRivalsOfAll = 60'000'000;  // ... and more while all of them fit into a gigabyte

bool is_farther(const RivalAtPlace& a, const RivalAtPlace& b) {
  return a.distance > b.distance || (a.distance == b.distance && a.rival < b.rival);
}

std::vector<Fixture> landmarks(const Building& building, bool with_elements) {
  std::vector<Fixture> fixtures = building.fixtures;
  if (with_elements) {
    for (const CeilingElement& element : building.elements) {
      Fixture fixture;
      fixture.id = -1;
      fixture.shape = element.kind == ElementKind::kDetector || element.kind == ElementKind::kSpeaker
                          ? FixtureShape::kRound
                      : element.length == element.width ? FixtureShape::kSquare
                                                        : FixtureShape::kRectangle;
      fixture.world_from_fixture = element.world_from_element;
      fixture.length = element.length;
      fixture.width = element.width;
      fixture.height = building.ceiling_height;
      fixture.lamps = kElementLamps + static_cast<int>(element.kind);
      fixtures.push_back(fixture);
    }
  }
  return fixtures;
}

bool is_same_kind(const Fixture& a, const Fixture& b) {
  const bool are_elements = a.lamps >= kElementLamps || b.lamps >= kElementLamps;
  return a.shape == b.shape && std::abs(a.length - b.length) < 0.15 && std::abs(a.width - b.width) < 0.08 &&
         (!are_elements || a.lamps == b.lamps);
}

}  // namespace

AmbiguityAudit::AmbiguityAudit(const Building& building, const PriorMap& walls, const CameraDescription& camera,
                               const AuditParams& params)
    : params_(params),
      map_(landmarks(building, params.with_elements)),
      walls_(walls),
      view_radius_(CeilingView(camera).mean_radius(building.ceiling_height)) {
  find_places(walls);
  find_motions();
  find_rivals();
  std::vector<double> distance(places_.size(), 0.0);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const std::vector<RivalAtPlace>& rivals = ground_.rivals[i];
    places_[i].aliases = places_[i].is_blind ? 0 : places_[i].aliases;
    distance[i] = rivals.empty() ? 0.0 : rivals.front().distance;
  }
  add_blind_distances(distance);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    places_[i].min_distance = distance[i];
    never_share_ += std::isinf(distance[i]) ? 1.0 / static_cast<double>(places_.size()) : 0.0;
  }
  mean_min_distance_ = mean_of(distance);
}

void AmbiguityAudit::find_rivals() {
  ground_.rivals.resize(places_.size());
  for (std::size_t m = 0; m < motions_.size(); ++m) {
    const std::vector<PlaceDistance> found = distances(image_of(motions_[m].alias_from_true), -1);
    for (const PlaceDistance& each : found) {
      motions_[m].sum += std::min<double>(each.distance, params_.never_distance);
    }
    add_rivals(static_cast<std::int32_t>(m), found);
  }
  std::vector<std::int32_t> costliest_first(motions_.size());
  std::iota(costliest_first.begin(), costliest_first.end(), 0);
  const auto motion = [&](std::int32_t m) -> const Motion& { return motions_[static_cast<std::size_t>(m)]; };
  std::stable_sort(costliest_first.begin(), costliest_first.end(),
                   [&](std::int32_t a, std::int32_t b) { return motion(a).sum > motion(b).sum; });
  std::vector<std::int32_t> rank(motions_.size());
  std::vector<Motion> sorted;
  for (const std::int32_t m : costliest_first) {
    rank[static_cast<std::size_t>(m)] = static_cast<std::int32_t>(sorted.size());
    sorted.push_back(motion(m));
  }
  motions_ = std::move(sorted);
  ground_.rival_count = motions_.size();
  for (std::vector<RivalAtPlace>& rivals : ground_.rivals) {
    for (RivalAtPlace& each : rivals) {
      each.rival = rank[static_cast<std::size_t>(each.rival)];
    }
    std::sort(rivals.begin(), rivals.end(), is_farther);
  }
}

void AmbiguityAudit::add_rivals(std::int32_t motion, const std::vector<PlaceDistance>& distances) {
  const std::size_t max = std::max(kMinRivals, kMaxRivalsOfAll / places_.size());
  for (const PlaceDistance& each : distances) {
    ++places_[static_cast<std::size_t>(each.place)].aliases;
    std::vector<RivalAtPlace>& rivals = ground_.rivals[static_cast<std::size_t>(each.place)];
    rivals.push_back({motion, each.distance});
    if (rivals.size() >= 2 * max) {
      std::nth_element(rivals.begin(), rivals.begin() + static_cast<std::ptrdiff_t>(max), rivals.end(), is_farther);
      rivals.resize(max);
    }
  }
}

void AmbiguityAudit::find_places(const PriorMap& walls) {
  Eigen::Vector2d min = Eigen::Vector2d::Zero();
  Eigen::Vector2d max = Eigen::Vector2d::Zero();
  if (walls_.has_walls()) {
    min = walls.geometry.origin;
    max = min + walls.geometry.resolution * Eigen::Vector2d(walls.geometry.columns, walls.geometry.rows);
  } else if (map_.size() > 0) {
    min = max = map_[0].world_from_fixture.position();
    for (const Fixture& fixture : map_.fixtures()) {
      min = min.cwiseMin(fixture.world_from_fixture.position());
      max = max.cwiseMax(fixture.world_from_fixture.position());
    }
    min -= Eigen::Vector2d::Constant(1.5);
    max += Eigen::Vector2d::Constant(1.5);
  }
  grid_.resolution = params_.cell;
  grid_.origin = min;
  grid_.columns = static_cast<int>(std::ceil((max.x() - min.x()) / params_.cell));
  grid_.rows = static_cast<int>(std::ceil((max.y() - min.y()) / params_.cell));
  place_of_cell_.assign(grid_.size(), -1);
  for (int row = 0; row < grid_.rows; ++row) {
    for (int column = 0; column < grid_.columns; ++column) {
      const Eigen::Vector2d point = grid_.centre_of({column, row});
      if (walls_.is_free(point) && walls_.distance_to_wall(point) > params_.clearance) {
        place_of_cell_[grid_.index({column, row})] = static_cast<std::int32_t>(places_.size());
        in_view_.emplace_back();
        map_.find_near(point, view_radius_, in_view_.back());
        places_.push_back({point, in_view_.back().empty(), 0, 0.0});
        ground_.points.push_back(point);
        ground_.is_blind.push_back(in_view_.back().empty());
      }
    }
  }
  places_of_.resize(static_cast<std::size_t>(map_.size()));
  for (std::size_t i = 0; i < places_.size(); ++i) {
    for (const int index : in_view_[i]) {
      places_of_[static_cast<std::size_t>(index)].push_back(static_cast<std::int32_t>(i));
    }
  }
  ground_.neighbours.resize(places_.size());
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const Cell cell = grid_.cell_at(places_[i].point);
    for (int row = cell.row - 1; row <= cell.row + 1; ++row) {
      for (int column = cell.column - 1; column <= cell.column + 1; ++column) {
        if (grid_.contains({column, row}) && Cell{column, row} != cell) {
          const std::int32_t other = place_of_cell_[grid_.index({column, row})];
          if (other >= 0) {
            ground_.neighbours[i].push_back(other);
          }
        }
      }
    }
  }
}

bool AmbiguityAudit::is_alike(const Fixture& a, const Pose2& world_from_a, const Fixture& b) const {
  return is_same_kind(a, b) && distance(world_from_a, b.world_from_fixture) < params_.position_tolerance &&
         std::abs(wrap_modulo(world_from_a.theta - b.world_from_fixture.theta, symmetry_period(b.shape))) <
             params_.heading_tolerance;
}

AmbiguityAudit::MotionImage AmbiguityAudit::image_of(const Pose2& alias_from_true) const {
  const auto count = static_cast<std::size_t>(map_.size());
  MotionImage motion{alias_from_true, std::vector<bool>(count), std::vector<int>(count, -1)};
  std::vector<int> near;
  for (int i = 0; i < map_.size(); ++i) {
    const Pose2 moved = alias_from_true * map_[i].world_from_fixture;
    near.clear();
    map_.find_near(moved.position(), params_.position_tolerance, near);
    for (const int other : near) {
      if (is_alike(map_[i], moved, map_[other])) {
        motion.image[static_cast<std::size_t>(i)] = other;
        motion.is_hit[static_cast<std::size_t>(other)] = true;
      }
    }
  }
  return motion;
}

void AmbiguityAudit::find_motions() {
  std::set<std::tuple<int, int, int>> known;
  std::vector<bool> is_seen(static_cast<std::size_t>(map_.size()), false);
  for (const std::vector<int>& fixtures : in_view_) {
    for (const int index : fixtures) {
      is_seen[static_cast<std::size_t>(index)] = true;
    }
  }
  for (int from = 0; from < map_.size(); ++from) {
    const double period = symmetry_period(map_[from].shape);
    if (!is_seen[static_cast<std::size_t>(from)] || period == 0.0) {
      continue;  // a round one leaves all headings open; others in view with it count
    }
    const int turns = static_cast<int>(std::lround(2.0 * kPi / period));
    for (int to = 0; to < map_.size(); ++to) {
      if (!is_same_kind(map_[from], map_[to])) {
        continue;
      }
      for (int turn = from == to ? 1 : 0; turn < turns; ++turn) {
        const Pose2 motion = map_[to].world_from_fixture * Pose2{0.0, 0.0, wrap_angle(turn * period)} *
                             map_[from].world_from_fixture.inverse();
        // the same motion of the plane lays many fixtures on others: once is enough
        const Eigen::Vector2d middle = motion * map_[from].world_from_fixture.position();
        const Eigen::Vector2d origin = motion * places_.front().point;
        const auto key = std::tuple(static_cast<int>(std::lround(wrap_angle(motion.theta) / radians(6.0))),
                                    static_cast<int>(std::lround(origin.x() / params_.position_tolerance)),
                                    static_cast<int>(std::lround(origin.y() / params_.position_tolerance)));
        if (middle.allFinite() && known.insert(key).second) {
          motions_.push_back({motion});
        }
      }
    }
  }
}

bool AmbiguityAudit::is_alias(const MotionImage& motion, std::size_t place, int changed) const {
  const Eigen::Vector2d alias = motion.alias_from_true * places_[place].point;
  if (!walls_.is_free(alias) || walls_.distance_to_wall(alias) < params_.alias_clearance) {
    return false;
  }
  for (const int index : in_view_[place]) {
    const auto i = static_cast<std::size_t>(index);
    if (motion.image[i] < 0 || ((index == changed || motion.image[i] == changed) && motion.image[i] != index)) {
      return false;
    }
  }
  // what the alias would see and the robot does not; at the border of the view tolerance decides
  thread_local std::vector<int> near;
  near.clear();
  map_.find_near(alias, view_radius_ - params_.position_tolerance, near);
  return std::all_of(near.begin(), near.end(),
                     [&](int index) { return motion.is_hit[static_cast<std::size_t>(index)]; });
}

std::vector<std::int32_t> AmbiguityAudit::connected_aliases(const MotionImage& motion, int changed,
                                                            std::vector<AliasKind>& kind) const {
  std::vector<std::int32_t> aliases;
  const auto touch = [&](std::int32_t place) {
    const auto i = static_cast<std::size_t>(place);
    if (kind[i] == AliasKind::kUntouched) {
      kind[i] = is_alias(motion, i, changed) ? AliasKind::kAlias : AliasKind::kRefuted;
      if (kind[i] == AliasKind::kAlias) {
        aliases.push_back(place);
      }
    }
  };
  for (std::size_t fixture = 0; fixture < places_of_.size(); ++fixture) {
    if (motion.image[fixture] >= 0) {
      std::for_each(places_of_[fixture].begin(), places_of_[fixture].end(), touch);
    }
  }
  std::size_t next = 0;
  while (next < aliases.size()) {  // it grows meanwhile
    const std::vector<std::int32_t>& around = ground_.neighbours[static_cast<std::size_t>(aliases[next++])];
    std::for_each(around.begin(), around.end(), touch);
  }
  return aliases;
}

std::vector<AmbiguityAudit::PlaceDistance> AmbiguityAudit::distances(const MotionImage& motion, int changed) const {
  std::vector<AliasKind> kind(places_.size(), AliasKind::kUntouched);
  std::vector<double> distance(places_.size(), kNever);
  const std::vector<std::int32_t> aliases = connected_aliases(motion, changed, kind);
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto relax = [&](std::size_t from, std::size_t to, double base) {
    const double length = base + (places_[from].point - places_[to].point).norm();
    if (length < distance[to]) {
      distance[to] = length;
      queue.emplace(length, to);
    }
  };
  for (const std::int32_t place : aliases) {
    for (const std::int32_t neighbour : ground_.neighbours[static_cast<std::size_t>(place)]) {
      if (kind[static_cast<std::size_t>(neighbour)] == AliasKind::kRefuted) {
        relax(static_cast<std::size_t>(neighbour), static_cast<std::size_t>(place), 0.0);
      }
    }
  }
  while (!queue.empty()) {
    const auto [length, place] = queue.top();
    queue.pop();
    if (length > distance[place]) {
      continue;
    }
    for (const std::int32_t neighbour : ground_.neighbours[place]) {
      if (kind[static_cast<std::size_t>(neighbour)] == AliasKind::kAlias) {
        relax(place, static_cast<std::size_t>(neighbour), length);
      }
    }
  }
  std::vector<PlaceDistance> result;
  result.reserve(aliases.size());
  for (const std::int32_t place : aliases) {
    result.push_back({place, static_cast<float>(distance[static_cast<std::size_t>(place)])});
  }
  return result;
}

void AmbiguityAudit::add_blind_distances(std::vector<double>& distance) const {
  // who sees nothing drives to where something is seen, and has to go on from there
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::vector<double> total(places_.size(), kNever);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    if (!places_[i].is_blind) {
      total[i] = distance[i];
      queue.emplace(total[i], i);
    }
  }
  while (!queue.empty()) {
    const auto [length, place] = queue.top();
    queue.pop();
    if (length > total[place]) {
      continue;
    }
    for (const std::int32_t neighbour : ground_.neighbours[place]) {
      const auto next = static_cast<std::size_t>(neighbour);
      const double longer = length + (places_[place].point - places_[next].point).norm();
      if (places_[next].is_blind && longer < total[next]) {
        total[next] = longer;
        queue.emplace(longer, next);
      }
    }
  }
  for (std::size_t i = 0; i < places_.size(); ++i) {
    distance[i] = places_[i].is_blind ? total[i] : distance[i];
  }
}

double AmbiguityAudit::mean_of(const std::vector<double>& distance) const {
  double sum = 0.0;
  for (const double each : distance) {
    sum += std::min(each, params_.never_distance);
  }
  return sum / std::max(1.0, static_cast<double>(distance.size()));
}

std::vector<int> AmbiguityAudit::costly_fixtures(const std::vector<MotionImage>& images) const {
  std::vector<double> cost(static_cast<std::size_t>(map_.size()), 0.0);
  for (std::size_t m = 0; m < images.size(); ++m) {
    for (std::size_t i = 0; i < cost.size(); ++i) {
      const int image = images[m].image[i];
      cost[i] += image >= 0 && image != static_cast<int>(i) ? motions_[m].sum : 0.0;
    }
  }
  std::vector<int> fixtures;
  for (int i = 0; i < map_.size(); ++i) {
    if (map_[i].id >= 0) {
      fixtures.push_back(i);
    }
  }
  std::stable_sort(fixtures.begin(), fixtures.end(),
                   [&](int a, int b) { return cost[static_cast<std::size_t>(a)] > cost[static_cast<std::size_t>(b)]; });
  fixtures.resize(std::min(kMaxCandidates, fixtures.size()));
  return fixtures;
}

std::vector<AuditChange> AmbiguityAudit::best_changes(std::size_t max) const {
  std::vector<AuditChange> changes;
  const std::size_t count = std::min(kMaxForChanges, motions_.size());
  if (count == 0 || mean_min_distance_ < params_.cell) {
    return changes;
  }
  // what the motions left out ask for stays
  std::vector<double> rest(places_.size(), 0.0);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const std::vector<RivalAtPlace>& rivals = ground_.rivals[i];
    const auto farthest = std::find_if(rivals.begin(), rivals.end(), [&](const RivalAtPlace& rival) {
      return static_cast<std::size_t>(rival.rival) >= count;
    });
    rest[i] = farthest == rivals.end() ? 0.0 : farthest->distance;
  }
  std::vector<MotionImage> images;
  for (std::size_t m = 0; m < count; ++m) {
    images.push_back(image_of(motions_[m].alias_from_true));
  }
  for (const int fixture : costly_fixtures(images)) {
    std::vector<double> distance = rest;
    for (std::size_t m = 0; m < count; ++m) {
      for (const PlaceDistance& each : distances(images[m], fixture)) {
        double& longest = distance[static_cast<std::size_t>(each.place)];
        longest = std::max<double>(longest, each.distance);
      }
    }
    add_blind_distances(distance);
    const auto never = std::count_if(distance.begin(), distance.end(), [](double each) { return std::isinf(each); });
    changes.push_back({map_[fixture].id, mean_of(distance),
                       static_cast<double>(never) / std::max(1.0, static_cast<double>(distance.size()))});
  }
  std::stable_sort(changes.begin(), changes.end(), [](const AuditChange& a, const AuditChange& b) {
    return a.mean_min_distance < b.mean_min_distance;
  });
  changes.resize(std::min(max, changes.size()));
  return changes;
}

}  // namespace luminav
