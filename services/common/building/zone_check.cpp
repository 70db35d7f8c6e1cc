#include "services/common/building/zone_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include "services/common/building/lane_map.hpp"
#include "services/common/building/standing_room.hpp"

namespace luminav {
namespace {

constexpr double kSmallest = 0.5;  // [m^2] less floor that is lost goes unsaid, unless a place is on it

/// True if some point, of a grid of 5 cm, is inside both: zones that only touch do not overlap.
bool overlap(const Polygon& a, const Polygon& b) {
  constexpr double kSpacing = 0.05;  // [m]
  const auto corner = [](const Polygon& polygon, bool is_low) {
    Eigen::Vector2d result = polygon.front();
    for (const Eigen::Vector2d& point : polygon) {
      result = is_low ? Eigen::Vector2d(result.cwiseMin(point)) : Eigen::Vector2d(result.cwiseMax(point));
    }
    return result;
  };
  const Eigen::Vector2d low = corner(a, true).cwiseMax(corner(b, true));
  const Eigen::Vector2d high = corner(a, false).cwiseMin(corner(b, false));
  for (double y = low.y() + 0.5 * kSpacing; y < high.y(); y += kSpacing) {
    for (double x = low.x() + 0.5 * kSpacing; x < high.x(); x += kSpacing) {
      if (contains(a, {x, y}) && contains(b, {x, y})) {
        return true;
      }
    }
  }
  return false;
}

/// Why two zones that overlap cannot both be meant; "" = they can, as a slow one-way zone.
std::string contradiction(const Zone& a, const Zone& b) {
  if (a.kind == ZoneKind::kKeepOut || b.kind == ZoneKind::kKeepOut) {
    return a.kind == b.kind ? "one would do" : "what they share is never entered";
  }
  if (a.kind != b.kind) {
    return "";
  }
  if (a.kind == ZoneKind::kOneWay) {
    return a.direction == b.direction ? "one would do" : "what they share goes in both directions at once";
  }
  return a.kind == ZoneKind::kSlow && a.speed != b.speed ? "the lower speed holds" : "one would do";
}

class ZoneInspector {
 public:
  ZoneInspector(const BuildingSource& source, const PriorMap* map)
      : source_(source), building_(source.building), map_(map) {}

  std::vector<BuildingFinding> inspect() {
    note_hours();
    check_pairs();
    if (map_ != nullptr && !building_.zones.empty()) {
      check_places_on_map();
      const StandingRoom room(with_keep_out(*map_, building_.zones));
      check_cuts(room);
      check_lanes(room);
    }
    return std::move(findings_);
  }

 private:
  void add(FindingKind kind, std::size_t zone, std::string text) {
    findings_.push_back({kind, source_.zone_lines[zone], std::move(text)});
  }
  [[nodiscard]] std::string title(std::size_t zone) const {
    const std::string hours = text_of(building_.zones[zone].hours);
    return fmt::format("{} zone \"{}\"{}", name_of(building_.zones[zone].kind), building_.zones[zone].name,
                       hours.empty() ? "" : " (" + hours + ")");
  }

  void note_hours() {
    for (std::size_t i = 0; i < building_.zones.size(); ++i) {
      if (!are_always(building_.zones[i].hours)) {
        add(FindingKind::kNote, i, title(i) + " has hours; here it is judged as if it were always in force");
      }
    }
  }

  void check_pairs() {
    for (std::size_t i = 0; i < building_.zones.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const Zone& zone = building_.zones[i];
        const Zone& other = building_.zones[j];
        if (zone.name == other.name) {
          add(FindingKind::kWarning, i,
              fmt::format("two zones are called \"{}\" (line {}): nobody can tell which one refuses a goal", zone.name,
                          source_.zone_lines[j]));
        }
        const std::string why = contradiction(zone, other);
        if (!why.empty() && meet(zone.hours, other.hours) && overlap(zone.polygon, other.polygon)) {
          add(FindingKind::kWarning, i,
              fmt::format("{} overlaps {} (line {}): {}", title(i), title(j), source_.zone_lines[j], why));
        }
      }
    }
  }

  void check_places_on_map() {
    for (std::size_t i = 0; i < building_.zones.size(); ++i) {
      const std::vector<Eigen::Vector2d> points = edge_points(building_.zones[i].polygon, 0.5);
      if (std::none_of(points.begin(), points.end(), [&](const Eigen::Vector2d& point) {
            return map_->geometry.contains(map_->geometry.cell_at(point));
          })) {
        add(FindingKind::kWarning, i, fmt::format("{} lies outside the map", title(i)));
      }
    }
  }

  /// What is lost of the floor, said in one sentence.
  struct Loss {
    std::size_t cells = 0;
    std::size_t first = 0;  // index of a cell
    std::string names;      // of places and doors
  };
  template <typename IsLost>
  [[nodiscard]] Loss loss_where(const StandingRoom& room, const IsLost& is_lost) const {
    Loss loss;
    for (std::size_t i = 0; i < room.geometry().size(); ++i) {
      if (is_lost(i)) {
        loss.first = loss.cells++ == 0 ? i : loss.first;
      }
    }
    const auto note = [&](const Eigen::Vector2d& point, const std::string& name) {
      const Cell cell = room.geometry().cell_at(point);
      if (room.geometry().contains(cell) && is_lost(room.geometry().index(cell))) {
        loss.names += (loss.names.empty() ? ", with " : ", ") + name;
      }
    };
    for (const Place& place : building_.places) {
      note(place.pose.position(), fmt::format("place \"{}\"", place.name));
    }
    for (const Door& door : building_.doors) {
      note(door.world_from_door.position(), fmt::format("door {}", door.id));
    }
    return loss;
  }
  void report(const StandingRoom& room, const Loss& loss, std::size_t zone, const std::string& begins) {
    const GridGeometry& geometry = room.geometry();
    const double area = static_cast<double>(loss.cells) * geometry.resolution * geometry.resolution;
    if (area < kSmallest && loss.names.empty()) {
      return;
    }
    const auto columns = static_cast<std::size_t>(geometry.columns);
    const Eigen::Vector2d point =
        geometry.centre_of({static_cast<int>(loss.first % columns), static_cast<int>(loss.first / columns)});
    add(loss.names.empty() ? FindingKind::kWarning : FindingKind::kError, zone,
        fmt::format("{} {:.1f} m^2 of the floor, from ({:.1f}, {:.1f}) on{}", begins, area, point.x(), point.y(),
                    loss.names));
  }

  void check_cuts(const StandingRoom& room) {
    const StandingRoom whole(*map_);
    for (int part = 1; part <= room.parts(); ++part) {
      const Loss loss = part == room.largest() ? Loss{} : loss_where(room, [&](std::size_t cell) {
        return room.part(cell) == part && whole.part(cell) == whole.largest();
      });
      if (loss.cells == 0) {
        continue;
      }
      const std::optional<std::size_t> culprit = cutting_zone(loss.first);
      report(room, loss, culprit.value_or(first_of(ZoneKind::kKeepOut)),
             culprit ? title(*culprit) + " cuts off" : "the keep-out zones together cut off");
    }
  }
  /// The zone without which a cell belongs to the rest.
  [[nodiscard]] std::optional<std::size_t> cutting_zone(std::size_t cell) const {
    for (std::size_t i = 0; i < building_.zones.size(); ++i) {
      std::vector<Zone> others = building_.zones;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      const StandingRoom room(with_keep_out(*map_, others));
      if (building_.zones[i].kind == ZoneKind::kKeepOut && room.part(cell) == room.largest()) {
        return i;
      }
    }
    return std::nullopt;
  }
  [[nodiscard]] std::size_t first_of(ZoneKind kind) const {
    const auto first = std::find_if(building_.zones.begin(), building_.zones.end(),
                                    [&](const Zone& zone) { return zone.kind == kind; });
    return static_cast<std::size_t>(first - building_.zones.begin());
  }

  void check_lanes(const StandingRoom& room) {
    const LaneMap lanes(building_.zones, room.geometry());
    if (lanes.empty() || room.largest() == 0) {
      return;
    }
    PriorMap without = with_keep_out(*map_, building_.zones);
    for (std::size_t i = 0; i < without.cells.size(); ++i) {
      without.cells[i] = lanes.forbidden()[i] != 0 ? Prior::kOccupied : without.cells[i];
    }
    const std::vector<std::size_t> rest = largest_within(StandingRoom(without), room);
    for (const bool is_onward : {true, false}) {
      const std::vector<bool> reached = flood(room, lanes, rest, is_onward);
      const Loss loss =
          loss_where(room, [&](std::size_t cell) { return room.part(cell) == room.largest() && !reached[cell]; });
      report(room, loss, first_of(ZoneKind::kOneWay),
             is_onward ? "the one-way zones let no way lead into" : "the one-way zones let no way lead out of");
    }
  }
  /// Cells of the part that has most of the room's largest one: what is left of it beside the lanes, to and from which
  /// ways must lead.
  static std::vector<std::size_t> largest_within(const StandingRoom& beside, const StandingRoom& room) {
    std::vector<std::size_t> cells_of_part(static_cast<std::size_t>(beside.parts()) + 1, 0);
    for (std::size_t i = 0; i < room.geometry().size(); ++i) {
      cells_of_part[static_cast<std::size_t>(beside.part(i))] += room.part(i) == room.largest() ? 1 : 0;
    }
    const auto largest = std::max_element(cells_of_part.begin() + 1, cells_of_part.end()) - cells_of_part.begin();
    std::vector<std::size_t> cells;
    for (std::size_t i = 0; i < room.geometry().size(); ++i) {
      if (beside.part(i) == largest && room.part(i) == room.largest()) {
        cells.push_back(i);
      }
    }
    return cells;
  }
  /// Cells that ways from some lead to, or from which ways lead there.
  static std::vector<bool> flood(const StandingRoom& room, const LaneMap& lanes, std::vector<std::size_t> open,
                                 bool is_onward) {
    const GridGeometry& geometry = room.geometry();
    std::vector<bool> reached(geometry.size(), false);
    for (const std::size_t cell : open) {
      reached[cell] = true;
    }
    const auto columns = static_cast<std::size_t>(geometry.columns);
    while (!open.empty()) {
      const std::size_t here = open.back();
      open.pop_back();
      for (std::size_t i = 0; i < kLaneSteps.size(); ++i) {
        const int sign = is_onward ? 1 : -1;
        const Cell next{static_cast<int>(here % columns) + sign * kLaneSteps[i].column,
                        static_cast<int>(here / columns) + sign * kLaneSteps[i].row};
        const std::size_t there = geometry.contains(next) ? geometry.index(next) : here;
        const bool may = is_onward ? lanes.allows(here, there, i) : lanes.allows(there, here, i);
        if (!reached[there] && room.part(there) == room.largest() && may) {
          reached[there] = true;
          open.push_back(there);
        }
      }
    }
    return reached;
  }

  const BuildingSource& source_;
  const Building& building_;
  const PriorMap* map_;
  std::vector<BuildingFinding> findings_;
};

}  // namespace

std::vector<BuildingFinding> check_zones(const BuildingSource& source, const PriorMap* map) {
  return ZoneInspector(source, map).inspect();
}

}  // namespace luminav
