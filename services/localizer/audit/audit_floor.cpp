#include "services/localizer/audit/audit_floor.hpp"

#include <algorithm>
#include <cmath>

#include "services/common/ceiling/ceiling_view.hpp"

namespace luminav {
namespace {

constexpr double kClearance = 0.25;                // [m] that the robot's middle keeps from walls
constexpr double kAliasClearance = 0.10;           // [m] nearer to a wall nobody can be: such an alias is refuted
constexpr double kHeadingTolerance = radians(12);  // [rad] fixtures turned by less are alike
constexpr int kRingTurns = 24;      // that the ring round a single round fixture is cut into, as the localizer does
constexpr double kRingReach = 6.0;  // [m] from a round fixture to what may come into view next ...
constexpr std::size_t kMaxPartners = 6;   // ... the nearest of which count
constexpr double kSameTurn = radians(3);  // motions that differ by less are one
constexpr double kIndexCell = 1.5;        // [m] most questions are for 0.25 m, some for the view

bool is_same_kind(const Fixture& a, const Fixture& b) {
  return a.shape == b.shape && std::abs(a.length - b.length) < 0.15 && std::abs(a.width - b.width) < 0.08;
}

double direction(const Fixture& from, const Fixture& to) {
  const Eigen::Vector2d apart = to.world_from_fixture.position() - from.world_from_fixture.position();
  return std::atan2(apart.y(), apart.x());
}

/// The motion that turns by `theta` and lays a fixture's centre on another's.
Pose2 motion_onto(const Fixture& from, const Fixture& to, double theta) {
  const Pose2& moved = from.world_from_fixture;
  return Pose2{to.world_from_fixture.x, to.world_from_fixture.y, wrap_angle(theta)} * Pose2{-moved.x, -moved.y, 0.0};
}

/// The floor in cells.
GridGeometry place_grid(const PriorMap& walls, const FixtureMap& map, double cell) {
  const Eigen::AlignedBox2d floor = extent_of_floor(walls, map);
  GridGeometry grid;
  grid.resolution = cell;
  grid.origin = floor.min();
  grid.columns = static_cast<int>(std::ceil(floor.sizes().x() / cell));
  grid.rows = static_cast<int>(std::ceil(floor.sizes().y() / cell));
  return grid;
}

}  // namespace

AuditFloor::AuditFloor(const Building& building, const PriorMap& walls, const CameraDescription& camera)
    : map_(building.fixtures, kIndexCell),
      walls_(walls),
      view_radius_(CeilingView(camera).mean_radius(building.ceiling_height)) {
  find_places(walls);
}

void AuditFloor::find_places(const PriorMap& walls) {
  const GridGeometry grid = place_grid(walls, map_, kCell);
  std::vector<std::int32_t> place_of_cell(grid.size(), -1);
  std::vector<Cell> cells;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const Eigen::Vector2d point = grid.centre_of({column, row});
      if (walls_.is_free(point) && walls_.distance_to_wall(point) > kClearance) {
        place_of_cell[grid.index({column, row})] = static_cast<std::int32_t>(cells.size());
        cells.push_back({column, row});
        ground_.points.push_back(point);
        in_view_.push_back(map_.near(point, view_radius_));
      }
    }
  }
  ground_.neighbours.resize(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (int turn = 0; turn < 9; ++turn) {
      const Cell next{cells[i].column + turn % 3 - 1, cells[i].row + turn / 3 - 1};
      if (next != cells[i] && grid.contains(next) && place_of_cell[grid.index(next)] >= 0) {
        ground_.neighbours[i].push_back(place_of_cell[grid.index(next)]);
      }
    }
  }
}

int AuditFloor::anchor(std::int32_t place) const {
  const std::vector<int>& seen = in_view(place);
  const auto with_heading =
      std::find_if(seen.begin(), seen.end(), [&](int index) { return symmetry_period(map_[index].shape) > 0.0; });
  return with_heading == seen.end() ? seen.front() : *with_heading;
}

std::vector<int> AuditFloor::partners(int anchor, std::int32_t place) const {
  std::vector<int> found = in_view(place);
  const bool is_alone = found.size() < 2;
  if (is_alone) {
    found = map_.near(map_[anchor].world_from_fixture.position(), kRingReach);
  }
  std::erase(found, anchor);
  const auto away = [&](int index) {
    return distance(map_[index].world_from_fixture, map_[anchor].world_from_fixture);
  };
  std::stable_sort(found.begin(), found.end(), [&](int a, int b) { return away(a) < away(b); });
  if (!is_alone) {
    return {found.back()};  // the longest line tells the heading best
  }
  found.resize(std::min(kMaxPartners, found.size()));
  return found;
}

std::vector<double> AuditFloor::turns(int anchor, const std::vector<int>& partners, int to) const {
  const double period = symmetry_period(map_[anchor].shape);
  std::vector<double> turns;
  const auto add = [&](double turn) {
    if (std::none_of(turns.begin(), turns.end(),
                     [&](double known) { return std::abs(wrap_angle(known - turn)) < kSameTurn; })) {
      turns.push_back(turn);
    }
  };
  if (period > 0.0) {
    const double first = map_[to].world_from_fixture.theta - map_[anchor].world_from_fixture.theta;
    for (int turn = 0; turn < std::lround(2.0 * kPi / period); ++turn) {
      add(first + turn * period);
    }
    return turns;
  }
  for (const int partner : partners) {
    const double length = distance(map_[anchor].world_from_fixture, map_[partner].world_from_fixture);
    for (const int other : map_.near(map_[to].world_from_fixture.position(), length + kPositionTolerance)) {
      if (other != to && is_same_kind(map_[partner], map_[other]) &&
          distance(map_[to].world_from_fixture, map_[other].world_from_fixture) > length - kPositionTolerance) {
        add(direction(map_[to], map_[other]) - direction(map_[anchor], map_[partner]));
      }
    }
  }
  return turns;
}

std::vector<AliasMotion> AuditFloor::aliases(std::int32_t place, int changed) const {
  std::vector<AliasMotion> motions;
  if (is_blind(place)) {
    return motions;
  }
  const int from = anchor(place);
  const bool is_round = symmetry_period(map_[from].shape) == 0.0;
  const std::vector<int> partners = is_round ? this->partners(from, place) : std::vector<int>{};
  const Eigen::Vector2d& point = ground_.points[static_cast<std::size_t>(place)];
  const auto add = [&](int to, double theta) {
    const AliasMotion motion(motion_onto(map_[from], map_[to], theta));
    const bool is_itself = (motion.alias_from_true * point - point).norm() < kPositionTolerance &&
                           std::abs(wrap_angle(theta)) < kHeadingTolerance;
    if (!is_itself && is_alias(motion, place, changed)) {
      motions.push_back(motion);
    }
  };
  for (int to = 0; to < map_.size(); ++to) {
    if (is_same_kind(map_[from], map_[to])) {
      for (const double theta : turns(from, partners, to)) {
        add(to, theta);
      }
    }
  }
  for (int turn = 1; is_round && in_view(place).size() == 1 && turn < kRingTurns; ++turn) {
    add(from, 2.0 * kPi * turn / kRingTurns);
  }
  return motions;
}

bool AuditFloor::is_alike(int index, const Eigen::Vector2d& moved, double turn, int other, int changed) const {
  const Fixture& a = map_[index];
  const Fixture& b = map_[other];
  return is_same_kind(a, b) && (index == changed) == (other == changed) &&
         (moved - b.world_from_fixture.position()).norm() < kPositionTolerance &&
         std::abs(wrap_modulo(a.world_from_fixture.theta + turn - b.world_from_fixture.theta,
                              symmetry_period(b.shape))) < kHeadingTolerance;
}

bool AuditFloor::has_image(const PointTransform& motion, double turn, int index, int changed) const {
  const Eigen::Vector2d moved = motion * map_[index].world_from_fixture.position();
  const std::vector<int> near = map_.near(moved, kPositionTolerance);
  return std::any_of(near.begin(), near.end(), [&](int other) { return is_alike(index, moved, turn, other, changed); });
}

bool AuditFloor::is_alias(const AliasMotion& motion, std::int32_t place, int changed) const {
  const Eigen::Vector2d alias = motion.alias_from_true * ground_.points[static_cast<std::size_t>(place)];
  if (!walls_.is_free(alias) || walls_.distance_to_wall(alias) < kAliasClearance) {
    return false;
  }
  const std::vector<int>& seen = in_view(place);
  if (!std::all_of(seen.begin(), seen.end(),
                   [&](int index) { return has_image(motion.alias_from_true, motion.theta, index, changed); })) {
    return false;
  }
  // what the alias would see and the robot does not; at the border of the view tolerance decides
  const std::vector<int> near = map_.near(alias, view_radius_ - kPositionTolerance);
  return std::all_of(near.begin(), near.end(),
                     [&](int index) { return has_image(motion.true_from_alias, -motion.theta, index, changed); });
}

}  // namespace luminav
