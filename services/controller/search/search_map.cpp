#include "services/controller/search/search_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <utility>

namespace luminav {
namespace {

constexpr double kSide = 40.0;        // [m] of the square it covers, which goes along with the robot
constexpr double kLeeway = 6.0;       // [m] off the middle of the square it goes along
constexpr double kCell = 0.1;         // [m]
constexpr double kMaxFree = 2.5;      // [m] farther a ray says nothing
constexpr double kMaxSilent = 0.8;    // [m] likewise of one without an echo: smooth walls are silent too
constexpr double kEchoMargin = 0.12;  // [m] before an echo the ray is not free
// [m] between the robot's middle and what stands: the first that leads anywhere; arcs make doorways look narrow.
constexpr std::array kClearances{0.4, 0.3, 0.2};
constexpr double kSeenAround = 1.3;     // [m] around its trail it knows the ceiling
constexpr double kBlockedAround = 0.5;  // [m] around a place that it could not reach
constexpr double kShutAround = 0.3;     // [m] around a place that it could not drive through

constexpr std::int8_t kStands = 2;      // evidence from which a cell counts as occupied
constexpr std::int8_t kFreeLimit = -4;  // evidence is bounded, so that people who went away are forgotten
constexpr std::int8_t kOccupiedLimit = 6;
constexpr std::int8_t kFirm = 4;  // two echoes: the arc of a door post alone does not count as a wall
constexpr std::int8_t kEcho = 2;  // what one echo says, against 1 for a free ray: walls are silent when seen at a slant
constexpr double kConeHalf = radians(10.0);  // the part of the cone that no neighbouring disc sees better
constexpr int kBorder = 20;                  // cells: more than the largest radius that is looked at
constexpr int kSameSide = 18;                // [1/256 turn] 25 degrees

std::int8_t in_256ths(double theta) {
  return static_cast<std::int8_t>(std::lround(wrap_angle(theta) * 128.0 / kPi) & 0xff);
}

}  // namespace

SearchMap::SearchMap(const SonarRing& ring)
    : ring_(ring), columns_(static_cast<int>(std::ceil(kSide / kCell))), taken_up_(ring.robot_from_sonar.size(), 0) {}

void SearchMap::clear() {
  origin_.reset();
  cells_.clear();
  std::fill(taken_up_.begin(), taken_up_.end(), 0);
}

int SearchMap::index_of(const Eigen::Vector2d& place) const {
  const Eigen::Vector2d inside = (place - *origin_) / kCell;
  const int column = static_cast<int>(std::floor(inside.x()));
  const int row = static_cast<int>(std::floor(inside.y()));
  // near the border nothing is entered, so that neighbours need no check
  const auto is_inside = [&](int i) { return i >= kBorder && i < columns_ - kBorder; };
  return is_inside(column) && is_inside(row) ? row * columns_ + column : -1;
}

Eigen::Vector2d SearchMap::centre_of(int index) const {
  return *origin_ + kCell * Eigen::Vector2d(index % columns_ + 0.5, index / columns_ + 0.5);
}

std::vector<int> SearchMap::disc_offsets(double radius) const {
  const int reach = static_cast<int>(radius / kCell);
  std::vector<int> offsets;
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      if (std::hypot(row, column) * kCell <= radius) {
        offsets.push_back(row * columns_ + column);
      }
    }
  }
  return offsets;
}

// By whole cells, so that they keep what they hold. The border stays empty: a search that came into it would leave the
// square, and what lies there could not be blocked.
void SearchMap::go_along(const Eigen::Vector2d& place) {
  const Eigen::Vector2d corner = place - Eigen::Vector2d::Constant(0.5 * kSide);
  const auto count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(columns_);
  if (!origin_) {
    origin_ = corner;
    cells_.assign(count, {});
    return;
  }
  if ((corner - *origin_).lpNorm<Eigen::Infinity>() < kLeeway && index_of(place) >= 0) {
    return;
  }
  const Eigen::Vector2i shift = ((corner - *origin_) / kCell).array().round().cast<int>();
  std::vector<Cell> moved(count);
  const auto first_of = [](int shifted) { return std::max(kBorder, -shifted); };
  const auto end_of = [this](int shifted) { return std::min(columns_ - kBorder, columns_ - shifted); };
  const int first = first_of(shift.x());
  const int last = end_of(shift.x());
  for (int row = first_of(shift.y()); row < end_of(shift.y()) && first < last; ++row) {
    const auto from = cells_.begin() + (row + shift.y()) * columns_;
    std::copy(from + (first + shift.x()), from + (last + shift.x()), moved.begin() + row * columns_ + first);
  }
  cells_ = std::move(moved);
  *origin_ += kCell * shift.cast<double>();
}

void SearchMap::visit(const Eigen::Vector2d& place) {
  go_along(place);
  mark_seen(place, kSeenAround);
  for (const int offset : disc_offsets(0.2)) {
    Cell& cell = cells_[static_cast<std::size_t>(index_of(place) + offset)];
    cell.occupied = kFreeLimit;
    cell.shut = 0;
  }
}

void SearchMap::fade() {
  for (Cell& cell : cells_) {
    cell.occupied = cell.occupied > 0 ? static_cast<std::int8_t>(cell.occupied - 1) : cell.occupied;
    cell.shut = cell.shut > 0 ? static_cast<std::int8_t>(cell.shut - 1) : cell.shut;
  }
}

void SearchMap::block(const Eigen::Vector2d& place) {
  if (origin_) {
    mark_seen(place, kBlockedAround);
  }
}

void SearchMap::shut(const Eigen::Vector2d& place) {
  const int centre = origin_ ? index_of(place) : -1;
  if (centre < 0) {
    return;
  }
  for (const int offset : disc_offsets(kShutAround)) {
    cells_[static_cast<std::size_t>(centre + offset)].shut = static_cast<std::int8_t>(kShutFor);
  }
}

void SearchMap::mark_seen(const Eigen::Vector2d& place, double radius) {
  const int centre = index_of(place);
  if (centre < 0) {
    return;
  }
  for (const int offset : disc_offsets(radius)) {
    cells_[static_cast<std::size_t>(centre + offset)].is_seen = true;
  }
}

void SearchMap::add(std::span<const SonarFiring> newest) {
  for (const SonarFiring& firing : newest) {
    if (firing.disc < taken_up_.size() && firing.utime > taken_up_[firing.disc]) {
      taken_up_[firing.disc] = firing.utime;
      if (origin_) {
        add(firing);
      }
    }
  }
}

// A ray ends at what was heard from another side: a smooth wall is silent when seen at a slant, and what is heard then
// stands in its mirror. From about the same side it takes back what was heard.
std::vector<int> SearchMap::free_cells(const Pose2& odom_from_sonar, double free) const {
  constexpr int kRays = 5;
  std::vector<int> cells;
  for (int i = 0; i < kRays; ++i) {
    const double angle = kConeHalf * (2.0 * i / (kRays - 1) - 1.0);
    const std::int8_t direction = in_256ths(odom_from_sonar.theta + angle);
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    for (double distance = 0.0; distance < free; distance += kCell) {
      const int index = index_of(odom_from_sonar * Eigen::Vector2d(distance * along));
      if (index < 0) {
        break;
      }
      const Cell& cell = cells_[static_cast<std::size_t>(index)];
      const auto apart = static_cast<std::int8_t>(direction - cell.heard);
      if (cell.occupied >= kFirm && std::abs(apart) > kSameSide) {
        break;
      }
      cells.push_back(index);
    }
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

void SearchMap::add(const SonarFiring& firing) {
  const Pose2 odom_from_sonar = firing.odom_from_robot * ring_.robot_from_sonar[firing.disc];
  const double range = firing.has_echo ? firing.range : kMaxSilent + kEchoMargin;
  for (const int index : free_cells(odom_from_sonar, std::min(kMaxFree, range - kEchoMargin))) {
    std::int8_t& value = cells_[static_cast<std::size_t>(index)].occupied;
    value = std::max<std::int8_t>(kFreeLimit, static_cast<std::int8_t>(value - 1));
  }
  if (!firing.has_echo || range > kMaxFree) {
    return;
  }
  const int steps = std::max(2, static_cast<int>(std::ceil(2.0 * kConeHalf * range / (0.7 * kCell))));
  int last = -1;
  for (int i = 0; i <= steps; ++i) {
    const double angle = kConeHalf * (2.0 * i / steps - 1.0);
    const int index = index_of(odom_from_sonar * Eigen::Vector2d(range * std::cos(angle), range * std::sin(angle)));
    if (index >= 0 && index != last) {
      Cell& cell = cells_[static_cast<std::size_t>(index)];
      cell.occupied = std::clamp<std::int8_t>(static_cast<std::int8_t>(cell.occupied + kEcho), kStands, kOccupiedLimit);
      cell.heard = in_256ths(odom_from_sonar.theta + angle);
      last = index;
    }
  }
}

bool SearchMap::is_near_trail(const Eigen::Vector2d& place) const {
  const int index = origin_ ? index_of(place) : -1;
  return index >= 0 && cells_[static_cast<std::size_t>(index)].is_seen;
}

bool SearchMap::is_shut(const Eigen::Vector2d& place) const {
  const int index = origin_ ? index_of(place) : -1;
  return index >= 0 && cells_[static_cast<std::size_t>(index)].shut > 0;
}

Ground SearchMap::ground_at(const Eigen::Vector2d& place) const {
  const int index = origin_ ? index_of(place) : -1;
  if (index < 0) {
    return Ground::kUnknown;
  }
  const Cell& cell = cells_[static_cast<std::size_t>(index)];
  return cell.occupied >= kStands || cell.shut > 0 ? Ground::kStands
         : cell.occupied < 0                       ? Ground::kFree
                                                   : Ground::kUnknown;
}

bool SearchMap::stands_within(const Eigen::Vector2d& place, double radius) const {
  const int centre = origin_ ? index_of(place) : -1;
  if (centre < 0) {
    return false;
  }
  const int reach = static_cast<int>(radius / kCell);
  const int max = static_cast<int>(radius * radius / (kCell * kCell) + 1e-6);  // [cells squared]
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      if (row * row + column * column <= max &&
          cells_[static_cast<std::size_t>(centre + row * columns_ + column)].occupied >= kStands) {
        return true;
      }
    }
  }
  return false;
}

std::optional<std::vector<Eigen::Vector2d>> SearchMap::path_to_new_ground(const Eigen::Vector2d& place) const {
  if (!origin_) {
    return std::nullopt;
  }
  for (const double clearance : kClearances) {
    if (auto path = search(place, clearance)) {
      return path;
    }
  }
  return std::nullopt;
}

// Breadth first over free cells that keep the clearance, until one is not near the trail.
std::optional<std::vector<Eigen::Vector2d>> SearchMap::search(const Eigen::Vector2d& place, double clearance) const {
  const std::vector<int> around = disc_offsets(clearance);
  const auto is_passable = [&](int index) {
    const Cell& cell = cells_[static_cast<std::size_t>(index)];
    return cell.occupied < 0 && cell.shut == 0 && std::none_of(around.begin(), around.end(), [&](int offset) {
             return cells_[static_cast<std::size_t>(index + offset)].occupied >= kStands;
           });
  };
  const int start = index_of(place);
  if (start < 0) {
    return std::nullopt;
  }
  std::vector<int> from(cells_.size(), -1);
  std::deque<int> open;
  // where the robot stands there is room, whatever the sonars heard
  for (const int offset : disc_offsets(clearance)) {
    from[static_cast<std::size_t>(start + offset)] = start;
    open.push_back(start + offset);
  }
  while (!open.empty()) {
    const int index = open.front();
    open.pop_front();
    if (!cells_[static_cast<std::size_t>(index)].is_seen && cells_[static_cast<std::size_t>(index)].occupied <= -2) {
      std::vector<Eigen::Vector2d> path;
      for (int i = index; i != start; i = from[static_cast<std::size_t>(i)]) {
        path.push_back(centre_of(i));
      }
      std::reverse(path.begin(), path.end());
      return path;
    }
    for (const int step : {1, -1, columns_, -columns_, columns_ + 1, columns_ - 1, -columns_ + 1, -columns_ - 1}) {
      const int next = index + step;
      if (from[static_cast<std::size_t>(next)] < 0 && is_passable(next)) {
        from[static_cast<std::size_t>(next)] = index;
        open.push_back(next);
      }
    }
  }
  return std::nullopt;
}

}  // namespace luminav
