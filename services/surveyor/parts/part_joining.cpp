#include "services/surveyor/parts/part_joining.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "services/common/ceiling/ceiling_view.hpp"

namespace luminav {
namespace {

constexpr double kCoarse = 0.50;              // [m] by which fixtures of two maps may differ at first: both have bent
constexpr double kFine = 0.30;                // [m] after a fit
constexpr double kMaxTurn = radians(8.0);     // [rad] likewise, both
constexpr double kSigma = 0.08;               // [m] by which two maps of the same fixture differ
constexpr double kPairScore = 3.0;            // log ratio of a fixture where there is one and where one hangs by chance
constexpr std::size_t kMinPairs = 4;          // fewer fixtures lie alike by chance
constexpr double kMinScore = 18.0;            // log ratio from which the best motion is believed,
constexpr double kMargin = 6.0;               // and by which it has to lead
constexpr double kApart = 0.6;                // [m] between two motions' middles that are not the same,
constexpr double kApartTurn = radians(20.0);  // [rad] likewise
constexpr double kMaxInWalls = 0.02;          // of a path's images: a door may have been drawn shut
constexpr std::size_t kMaxRefined = 40;       // motions that are fitted
constexpr double kSight = 0.4;                // of the view's radius, within which no fixture is missed
constexpr double kCell = 0.1;                 // [m] of a floor that was passed
constexpr double kRestDistance = 0.06;        // [m] by which a fixture may seem to move before a robot at rest,
constexpr double kRestTurn = radians(3.0);    // [rad] likewise
constexpr double kKeyDistance = 0.25;         // [m] motions nearer than this are tried once,
constexpr double kKeyTurn = radians(4.0);     // [rad] likewise

std::pair<long, long> cell_of(const Eigen::Vector2d& point) {
  return {std::lround(point.x() / kCell), std::lround(point.y() / kCell)};
}

Eigen::Vector2d middle_of(const SurveyEstimate& estimate) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const SurveyedFixture& fixture : estimate.fixtures) {
    sum += fixture.world_from_fixture.position();
  }
  return sum / std::max<double>(1.0, static_cast<double>(estimate.fixtures.size()));
}

FixtureMap index_of(const SurveyEstimate& estimate, const CeilingKinds& kinds) {
  std::vector<Fixture> fixtures;
  for (const SurveyedFixture& surveyed : estimate.fixtures) {
    fixtures.push_back(kinds.kinds[static_cast<std::size_t>(surveyed.kind)]);
    fixtures.back().world_from_fixture = surveyed.world_from_fixture;
  }
  return FixtureMap(std::move(fixtures));
}

}  // namespace

double sight_of(const SurveyModel& model) {
  return kSight * CeilingView(model.robot.camera).mean_radius(model.kinds.ceiling_height);
}

PassedFloor::PassedFloor(const std::vector<Pose2>& poses, double sight) {
  const long reach = std::lround(sight / kCell);
  for (const Pose2& pose : poses) {
    const auto [column, row] = cell_of(pose.position());
    for (long dx = -reach; dx <= reach; ++dx) {
      for (long dy = -reach; dy <= reach; ++dy) {
        if (dx * dx + dy * dy <= reach * reach) {
          cells_.insert({column + dx, row + dy});
        }
      }
    }
  }
}

bool PassedFloor::contains(const Eigen::Vector2d& point) const {
  return cells_.count(cell_of(point)) > 0;
}

PartJoining::PartJoining(const SurveyEstimate& map, const SurveyEstimate& part, const CeilingKinds& kinds, double sight)
    : map_(map),
      part_(part),
      kinds_(kinds),
      map_index_(index_of(map, kinds)),
      map_floor_(map.poses, sight),
      part_floor_(part.poses, sight) {}

bool PartJoining::is_alike(const SurveyedFixture& a, const Pose2& map_from_b, const SurveyedFixture& b) const {
  const double period = symmetry_period(kinds_.kinds[static_cast<std::size_t>(a.kind)].shape);
  return a.kind == b.kind &&
         (period == 0.0 || std::abs(wrap_modulo(a.world_from_fixture.theta - map_from_b.theta, period)) < kMaxTurn);
}

std::vector<Pose2> PartJoining::candidates() const {
  const Eigen::Vector2d middle = middle_of(part_);
  std::set<std::tuple<long, long, long>> known;
  std::vector<Pose2> motions;
  for (const SurveyedFixture& a : map_.fixtures) {
    const double period = symmetry_period(kinds_.kinds[static_cast<std::size_t>(a.kind)].shape);
    const int turns = period == 0.0 ? 0 : static_cast<int>(std::lround(2.0 * kPi / period));
    for (const SurveyedFixture& b : part_.fixtures) {
      for (int turn = 0; turn < turns && a.kind == b.kind; ++turn) {
        const Pose2 motion =
            a.world_from_fixture * Pose2{0.0, 0.0, wrap_angle(turn * period)} * b.world_from_fixture.inverse();
        const Eigen::Vector2d to = motion * middle;
        if (known
                .insert({std::lround(to.x() / kKeyDistance), std::lround(to.y() / kKeyDistance),
                         std::lround(wrap_angle(motion.theta) / kKeyTurn)})
                .second) {
          motions.push_back(motion);
        }
      }
    }
  }
  return motions;
}

PartJoining::Match PartJoining::match(const Pose2& map_from_part, double tolerance) const {
  Match match{{map_from_part, {}}, 0.0};
  std::vector<bool> is_taken(map_.fixtures.size(), false);
  for (std::size_t b = 0; b < part_.fixtures.size(); ++b) {
    const Pose2 there = map_from_part * part_.fixtures[b].world_from_fixture;
    int best = -1;
    double nearest = tolerance;
    for (const int index : map_index_.near(there.position(), tolerance)) {
      const auto a = static_cast<std::size_t>(index);
      const double apart = distance(map_.fixtures[a].world_from_fixture, there);
      if (apart < nearest && !is_taken[a] && is_alike(map_.fixtures[a], there, part_.fixtures[b])) {
        nearest = apart;
        best = index;
      }
    }
    if (best >= 0) {
      is_taken[static_cast<std::size_t>(best)] = true;
      match.joint.pairs.push_back({best, static_cast<int>(b)});
      match.score += kPairScore - 0.5 * std::pow(nearest / kSigma, 2);
    }
  }
  if (match.joint.pairs.size() + 1 >= kMinPairs) {  // with fewer it is neither the best nor its rival
    match.score -= kPairScore * missed(match.joint);
  }
  return match;
}

int PartJoining::missed(const PartJoint& joint) const {
  std::vector<bool> is_paired(map_.fixtures.size(), false);
  std::vector<bool> is_paired_part(part_.fixtures.size(), false);
  for (const FixturePair& pair : joint.pairs) {
    is_paired[static_cast<std::size_t>(pair.first)] = true;
    is_paired_part[static_cast<std::size_t>(pair.second)] = true;
  }
  int missed = 0;
  for (std::size_t b = 0; b < part_.fixtures.size(); ++b) {
    const Eigen::Vector2d there = joint.map_from_part * part_.fixtures[b].world_from_fixture.position();
    missed += !is_paired_part[b] && map_floor_.contains(there) ? 1 : 0;
  }
  const Pose2 part_from_map = joint.map_from_part.inverse();
  for (std::size_t a = 0; a < map_.fixtures.size(); ++a) {
    const Eigen::Vector2d there = part_from_map * map_.fixtures[a].world_from_fixture.position();
    missed += !is_paired[a] && part_floor_.contains(there) ? 1 : 0;
  }
  return missed;
}

PartJoining::Match PartJoining::refine(const Match& rough) const {
  Eigen::Vector2d to_mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d from_mean = Eigen::Vector2d::Zero();
  const auto to = [&](const FixturePair& pair) {
    return map_.fixtures[static_cast<std::size_t>(pair.first)].world_from_fixture;
  };
  const auto from = [&](const FixturePair& pair) {
    return part_.fixtures[static_cast<std::size_t>(pair.second)].world_from_fixture;
  };
  const auto count = static_cast<double>(rough.joint.pairs.size());
  for (const FixturePair& pair : rough.joint.pairs) {
    to_mean += to(pair).position() / count;
    from_mean += from(pair).position() / count;
  }
  double sine = 0.0;
  double cosine = 0.0;
  for (const FixturePair& pair : rough.joint.pairs) {
    const Eigen::Vector2d p = to(pair).position() - to_mean;
    const Eigen::Vector2d q = from(pair).position() - from_mean;
    cosine += p.dot(q);
    sine += q.x() * p.y() - q.y() * p.x();
  }
  // one fixture alone, or all at one place, tell no turn: the headings' stays
  const double theta = std::hypot(sine, cosine) > 1.0 ? std::atan2(sine, cosine) : rough.joint.map_from_part.theta;
  const Pose2 turn{0.0, 0.0, theta};
  const Eigen::Vector2d shift = to_mean - turn * from_mean;
  return match({shift.x(), shift.y(), theta}, kFine);
}

bool PartJoining::crosses_walls(const Pose2& map_from_part) const {
  if (walls_ == nullptr) {
    return false;
  }
  const auto in_wall = std::count_if(part_.poses.begin(), part_.poses.end(), [&](const Pose2& pose) {
    return walls_->at((map_from_part * pose).position()) == Prior::kOccupied;
  });
  return static_cast<double>(in_wall) > kMaxInWalls * static_cast<double>(part_.poses.size());
}

std::optional<PartJoint> PartJoining::find() const {
  return best_of(candidates(), kMinScore);
}

std::optional<PartJoint> PartJoining::find_among(const std::vector<Pose2>& told) const {
  return best_of(told, 0.5 * kMinScore);
}

std::optional<PartJoint> PartJoining::best_of(const std::vector<Pose2>& motions, double min_score) const {
  std::vector<Match> matches;
  for (const Pose2& motion : motions) {
    Match found = match(motion, kCoarse);
    if (found.joint.pairs.size() >= 2) {
      matches.push_back(std::move(found));
    }
  }
  std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.score > b.score; });
  matches.resize(std::min(kMaxRefined, matches.size()));
  for (Match& each : matches) {
    each = refine(each);
    if (!each.joint.pairs.empty()) {
      each = refine(each);
    }
  }
  std::erase_if(matches, [this](const Match& each) { return crosses_walls(each.joint.map_from_part); });
  std::stable_sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.score > b.score; });
  if (matches.empty() || matches.front().joint.pairs.size() < kMinPairs) {
    return std::nullopt;
  }
  const Match& best = matches.front();
  const Eigen::Vector2d middle = middle_of(part_);
  const bool is_clear = std::all_of(matches.begin() + 1, matches.end(), [&](const Match& other) {
    const Pose2& a = best.joint.map_from_part;
    const Pose2& b = other.joint.map_from_part;
    const bool is_same =
        (a * middle - b * middle).norm() < kApart && std::abs(wrap_angle(a.theta - b.theta)) < kApartTurn;
    return is_same || other.score + kMargin <= best.score;
  });
  return best.score >= min_score && is_clear ? std::optional(best.joint) : std::nullopt;
}

std::optional<PartJoint> PartJoining::find_at_rest(const KeyFrame& last, const KeyFrame& first) const {
  const auto is_where_it_was = [&](const FixtureSighting& before, const FixtureSighting& after) {
    return before.shape == after.shape &&
           distance(before.robot_from_fixture, after.robot_from_fixture) < kRestDistance &&
           (!before.has_theta || !after.has_theta ||
            std::abs(wrap_modulo(before.robot_from_fixture.theta - after.robot_from_fixture.theta,
                                 symmetry_period(before.shape))) < kRestTurn);
  };
  int seen = 0;
  for (const FixtureSighting& before : last.sightings) {
    if (before.clipped || !before.has_theta) {
      continue;
    }
    ++seen;
    if (std::none_of(first.sightings.begin(), first.sightings.end(),
                     [&](const FixtureSighting& after) { return is_where_it_was(before, after); })) {
      return std::nullopt;
    }
  }
  if (seen == 0) {
    return std::nullopt;
  }
  const Match found = match(map_.poses.back() * part_.poses.front().inverse(), kFine);
  return found.joint.pairs.empty() ? std::nullopt : std::optional(found.joint);
}

}  // namespace luminav
