#include "services/common/building/building_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "services/common/building/alike_fixtures.hpp"
#include "services/common/building/standing_room.hpp"
#include "services/common/building/zone_check.hpp"

namespace luminav {
namespace {

constexpr double kShareInWall = 0.1;     // of a fixture's face; less is a map drawn by hand
constexpr double kLargestFixture = 2.5;  // [m] longer ones are rows of fixtures
constexpr double kNarrowestDoor = 0.6;   // [m] what the robot needs
constexpr double kDrop = 1.0;            // [m] round a place or a door: who stops or turns there comes so far

/// Points spread over a rectangle, in its own frame, a resolution apart at most.
std::vector<Eigen::Vector2d> points_of(double length, double width, double spacing) {
  std::vector<Eigen::Vector2d> points;
  const int columns = static_cast<int>(std::ceil(length / spacing)) + 1;
  const int rows = static_cast<int>(std::ceil(width / spacing)) + 1;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      points.emplace_back(length * (static_cast<double>(column) / std::max(1, columns - 1) - 0.5),
                          width * (static_cast<double>(row) / std::max(1, rows - 1) - 0.5));
    }
  }
  return points;
}

/// Separating axis test of two rectangles.
bool overlap(const Fixture& a, const Fixture& b) {
  const Eigen::Vector2d apart = b.world_from_fixture.position() - a.world_from_fixture.position();
  if (apart.norm() > 0.5 * (std::hypot(a.length, a.width) + std::hypot(b.length, b.width))) {
    return false;
  }
  if (a.shape == FixtureShape::kRound || b.shape == FixtureShape::kRound) {
    return apart.norm() < 0.5 * (a.width + b.width);
  }
  const auto half_extent = [](const Fixture& fixture, const Eigen::Vector2d& axis) {
    const double theta = fixture.world_from_fixture.theta;
    const Eigen::Vector2d along(std::cos(theta), std::sin(theta));
    return 0.5 * fixture.length * std::abs(along.dot(axis)) +
           0.5 * fixture.width * std::abs(Eigen::Vector2d(-along.y(), along.x()).dot(axis));
  };
  for (const double theta : {a.world_from_fixture.theta, b.world_from_fixture.theta}) {
    for (const Eigen::Vector2d& axis :
         {Eigen::Vector2d(std::cos(theta), std::sin(theta)), Eigen::Vector2d(-std::sin(theta), std::cos(theta))}) {
      if (std::abs(apart.dot(axis)) >= half_extent(a, axis) + half_extent(b, axis)) {
        return false;
      }
    }
  }
  return true;
}

/// Occupied cells in connected parts: what is large is a wall, what stands alone is furniture that was drawn into the
/// map.
class Walls {
 public:
  explicit Walls(const PriorMap& map) : geometry_(map.geometry), is_wall_(map.geometry.size(), false) {
    std::vector<bool> is_seen(geometry_.size(), false);
    for (std::size_t i = 0; i < is_seen.size(); ++i) {
      if (map.cells[i] == Prior::kOccupied && !is_seen[i]) {
        mark_part(map, i, is_seen);
      }
    }
  }
  [[nodiscard]] bool at(const Eigen::Vector2d& point) const {
    const Cell cell = geometry_.cell_at(point);
    return geometry_.contains(cell) && is_wall_[geometry_.index(cell)];
  }

 private:
  static constexpr double kLargestFurniture = 5.0;  // [m]

  void mark_part(const PriorMap& map, std::size_t start, std::vector<bool>& is_seen) {
    std::vector<Cell> part = {{static_cast<int>(start % static_cast<std::size_t>(geometry_.columns)),
                               static_cast<int>(start / static_cast<std::size_t>(geometry_.columns))}};
    is_seen[start] = true;
    Cell low = part.front();
    Cell high = part.front();
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Cell cell = part[i];
      low = {std::min(low.column, cell.column), std::min(low.row, cell.row)};
      high = {std::max(high.column, cell.column), std::max(high.row, cell.row)};
      for (int turn = 0; turn < 9; ++turn) {
        const Cell next{cell.column + turn % 3 - 1, cell.row + turn / 3 - 1};
        if (geometry_.contains(next) && !is_seen[geometry_.index(next)] &&
            map.cells[geometry_.index(next)] == Prior::kOccupied) {
          is_seen[geometry_.index(next)] = true;
          part.push_back(next);
        }
      }
    }
    const int extent = std::max(high.column - low.column, high.row - low.row);
    if (extent * geometry_.resolution > kLargestFurniture) {
      for (const Cell& cell : part) {
        is_wall_[geometry_.index(cell)] = true;
      }
    }
  }

  GridGeometry geometry_;
  std::vector<bool> is_wall_;
};

/// Distance [m] from a point to the nearest unknown cell, or the map's border, that a straight line over free floor
/// leads to; nothing within `farthest`.
std::optional<double> distance_to_unknown(const PriorMap& map, const Eigen::Vector2d& point, double farthest) {
  constexpr int kDirections = 72;
  const double step = 0.5 * map.geometry.resolution;
  std::optional<double> nearest;
  for (int i = 0; i < kDirections; ++i) {
    const double theta = 2.0 * kPi * i / kDirections;
    for (double way = 0.0; way <= nearest.value_or(farthest); way += step) {
      const Prior prior = map.at(point + way * Eigen::Vector2d(std::cos(theta), std::sin(theta)));
      if (prior == Prior::kUnknown) {
        nearest = way;
      }
      if (prior != Prior::kFree) {
        break;
      }
    }
  }
  return nearest;
}

class BuildingInspector {
 public:
  BuildingInspector(const BuildingSource& source, const PriorMap* map)
      : source_(source), building_(source.building), map_(map) {}

  std::vector<BuildingFinding> inspect() {
    check_sizes();
    check_overlaps();
    const std::vector<BuildingFinding> of_zones = check_zones(source_, map_);
    findings_.insert(findings_.end(), of_zones.begin(), of_zones.end());
    if (map_ != nullptr) {
      check_fixtures_on_map();
      check_doors();
      check_places();
    } else {
      add(FindingKind::kWarning, 1,
          "has no map: walls cannot be checked, and the robot plans through them until it saw them");
    }
    if (building_.fixtures.empty()) {
      add(FindingKind::kError, 1, "has no fixture: the robot can never find out where it is");
    }
    std::stable_sort(findings_.begin(), findings_.end(),
                     [](const BuildingFinding& a, const BuildingFinding& b) { return a.line < b.line; });
    note_alike_fixtures();
    return std::move(findings_);
  }

 private:
  void add(FindingKind kind, int line, std::string text) { findings_.push_back({kind, line, std::move(text)}); }

  void check_sizes() {
    for (std::size_t i = 0; i < building_.fixtures.size(); ++i) {
      const Fixture& fixture = building_.fixtures[i];
      const int line = source_.fixture_lines[i];
      if (fixture.length > kLargestFixture || fixture.width < 0.05) {
        add(FindingKind::kWarning, line,
            fmt::format(
                "fixture {} is {:.2f} x {:.2f} m: no shop sells that; is it a row of fixtures, or in other units?",
                fixture.id, fixture.length, fixture.width));
      }
      if (fixture.height > building_.ceiling_height + 0.01) {
        add(FindingKind::kWarning, line,
            fmt::format("fixture {} hangs at {:.2f} m, above the ceiling at {:.2f} m: is it higher there?", fixture.id,
                        fixture.height, building_.ceiling_height));
      } else if (fixture.height < 1.9) {
        add(FindingKind::kWarning, line,
            fmt::format("fixture {} hangs at {:.2f} m: people would hit their heads", fixture.id, fixture.height));
      }
    }
    for (std::size_t i = 0; i < building_.doors.size(); ++i) {
      if (building_.doors[i].width < kNarrowestDoor) {
        add(FindingKind::kWarning, source_.door_lines[i],
            fmt::format("door {} is {:.2f} m wide: the robot needs {:.1f} m", building_.doors[i].id,
                        building_.doors[i].width, kNarrowestDoor));
      }
    }
  }

  void check_overlaps() {
    for (std::size_t i = 0; i < building_.fixtures.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (overlap(building_.fixtures[i], building_.fixtures[j])) {
          const double apart =
              distance(building_.fixtures[i].world_from_fixture, building_.fixtures[j].world_from_fixture);
          add(FindingKind::kError, source_.fixture_lines[i],
              fmt::format("fixture {} overlaps fixture {} (line {}): their centres are {:.2f} m apart",
                          building_.fixtures[i].id, building_.fixtures[j].id, source_.fixture_lines[j], apart));
        }
      }
    }
  }

  void check_fixtures_on_map() {
    const Walls walls(*map_);
    for (std::size_t i = 0; i < building_.fixtures.size(); ++i) {
      const Fixture& fixture = building_.fixtures[i];
      const int line = source_.fixture_lines[i];
      const Cell cell = map_->geometry.cell_at(fixture.world_from_fixture.position());
      if (!map_->geometry.contains(cell)) {
        add(FindingKind::kError, line,
            fmt::format("fixture {} at ({:.2f}, {:.2f}) is outside the map", fixture.id, fixture.world_from_fixture.x,
                        fixture.world_from_fixture.y));
        continue;
      }
      const auto points = points_of(fixture.length, fixture.width, map_->geometry.resolution);
      const auto in_wall = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector2d& point) {
        return walls.at(fixture.world_from_fixture * point);
      });
      const double share = static_cast<double>(in_wall) / static_cast<double>(points.size());
      if (share > kShareInWall) {
        add(FindingKind::kError, line,
            fmt::format("fixture {} at ({:.2f}, {:.2f}) is in a wall: {:.0f} % of it", fixture.id,
                        fixture.world_from_fixture.x, fixture.world_from_fixture.y, 100.0 * share));
      } else if (map_->cells[map_->geometry.index(cell)] == Prior::kUnknown) {
        add(FindingKind::kWarning, line,
            fmt::format("fixture {} at ({:.2f}, {:.2f}) is where the map knows nothing", fixture.id,
                        fixture.world_from_fixture.x, fixture.world_from_fixture.y));
      }
    }
  }

  void check_doors() {
    for (std::size_t i = 0; i < building_.doors.size(); ++i) {
      const Door& door = building_.doors[i];
      if (map_->at(door.world_from_door.position()) != Prior::kFree) {
        add(FindingKind::kError, source_.door_lines[i],
            fmt::format("door {} at ({:.2f}, {:.2f}) is a wall in the map", door.id, door.world_from_door.x,
                        door.world_from_door.y));
      } else {
        warn_of_unknown(fmt::format("door {}", door.id), door.world_from_door.position(), source_.door_lines[i]);
      }
    }
  }

  void check_places() {
    const StandingRoom room(with_keep_out(*map_, building_.zones));
    for (std::size_t i = 0; i < building_.places.size(); ++i) {
      const Place& place = building_.places[i];
      const int part = room.part_at(place.pose.position());
      if (const Zone* zone = find_zone(building_.zones, ZoneKind::kKeepOut, place.pose.position())) {
        add(FindingKind::kError, source_.place_lines[i],
            fmt::format("place \"{}\" at ({:.2f}, {:.2f}) lies in the keep-out zone \"{}\": no goal there is taken",
                        place.name, place.pose.x, place.pose.y, zone->name));
      } else if (part == 0) {
        add(FindingKind::kError, source_.place_lines[i],
            fmt::format("place \"{}\" at ({:.2f}, {:.2f}): the robot does not fit there, a wall or a keep-out zone is "
                        "nearer than {:.2f} m",
                        place.name, place.pose.x, place.pose.y, StandingRoom::kRobotRadius));
      } else if (part != room.largest()) {
        add(FindingKind::kError, source_.place_lines[i],
            fmt::format("place \"{}\" at ({:.2f}, {:.2f}): no way leads there from most of the building", place.name,
                        place.pose.x, place.pose.y));
      } else {
        warn_of_unknown(fmt::format("place \"{}\"", place.name), place.pose.position(), source_.place_lines[i]);
      }
    }
  }

  /// What the map does not know and no wall shuts off may be a stair: no sense of the robot's looks down.
  void warn_of_unknown(const std::string& what, const Eigen::Vector2d& point, int line) {
    const std::optional<double> distance = distance_to_unknown(*map_, point, kDrop);
    if (distance) {
      add(FindingKind::kWarning, line,
          fmt::format("{} at ({:.2f}, {:.2f}) is {:.2f} m from what the map does not know: stairs there are seen by no "
                      "sense of the robot; put a keep-out zone before them",
                      what, point.x(), point.y(), *distance));
    }
  }

  void note_alike_fixtures() {
    const AlikeFixtures alike = find_alike_fixtures(building_);
    if (alike.without_heading > 0) {
      add(FindingKind::kWarning, 0,
          fmt::format("{} of {} fixtures are round with nothing but round ones within {:.0f} m: one alone tells no "
                      "heading, so the robot must drive until it saw two; `audit` says how far",
                      alike.without_heading, building_.fixtures.size(), kSurroundings));
    }
    if (alike.fixtures == 0) {
      add(FindingKind::kNote, 0, "every fixture is told apart by what hangs around it");
      return;
    }
    std::string examples;
    for (std::size_t i = 0; i < std::min<std::size_t>(alike.largest_group.size(), 5); ++i) {
      examples += fmt::format("{}{}", i == 0 ? "" : ", ", building_.fixtures[alike.largest_group[i]].id);
    }
    add(FindingKind::kNote, 0,
        fmt::format(
            "{} of {} fixtures look like another one with all that hangs within {:.0f} m; the largest such group "
            "has {} (ids {}{}): there the robot must drive on before it knows where it is",
            alike.fixtures, building_.fixtures.size(), kSurroundings, alike.largest_group.size(), examples,
            alike.largest_group.size() > 5 ? ", ..." : ""));
  }

  const BuildingSource& source_;
  const Building& building_;
  const PriorMap* map_;
  std::vector<BuildingFinding> findings_;
};

/// The building at a time when no zone with hours is in force.
BuildingSource without_hours(const BuildingSource& source) {
  BuildingSource result = source;
  for (std::size_t i = result.building.zones.size(); i-- > 0;) {
    if (!are_always(result.building.zones[i].hours)) {
      result.building.zones.erase(result.building.zones.begin() + static_cast<std::ptrdiff_t>(i));
      result.zone_lines.erase(result.zone_lines.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  return result;
}

bool is_among(const std::vector<BuildingFinding>& findings, const BuildingFinding& finding) {
  return std::any_of(findings.begin(), findings.end(), [&](const BuildingFinding& other) {
    return other.line == finding.line && other.text == finding.text;
  });
}

/// What is wrong at some hours is an error only if it is wrong at all of them.
void forgive_what_passes(const std::vector<BuildingFinding>& lasting, std::vector<BuildingFinding>& findings) {
  for (BuildingFinding& finding : findings) {
    if (finding.kind == FindingKind::kError && !is_among(lasting, finding)) {
      finding.kind = FindingKind::kWarning;
      finding.text += ", while zones with hours are in force";
    }
  }
  for (const BuildingFinding& finding : lasting) {
    if (finding.kind == FindingKind::kError && !is_among(findings, finding)) {
      findings.insert(findings.begin(), finding);
    }
  }
  std::stable_sort(findings.begin(), findings.end(), [](const BuildingFinding& a, const BuildingFinding& b) {
    return b.line == 0 ? a.line > 0 : a.line > 0 && a.line < b.line;
  });
}

}  // namespace

std::vector<BuildingFinding> check_building(const BuildingSource& source, const PriorMap* map) {
  std::vector<BuildingFinding> findings = BuildingInspector(source, map).inspect();
  if (const BuildingSource lasting = without_hours(source); lasting.zone_lines.size() < source.zone_lines.size()) {
    forgive_what_passes(BuildingInspector(lasting, map).inspect(), findings);
  }
  return findings;
}

}  // namespace luminav
