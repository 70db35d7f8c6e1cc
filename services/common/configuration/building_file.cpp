#include "services/common/configuration/building_file.hpp"

#include <fmt/format.h>

#include <set>
#include <tuple>

#include "services/common/configuration/fixture_table.hpp"
#include "services/common/configuration/toml_lines.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

constexpr Range kCoordinate{-1e5, 1e5};
constexpr Range kHeading{-7.0, 7.0};  // a full turn either way is accepted and wrapped

std::vector<Eigen::Vector2d> read_points(const TomlTable& table, std::string_view key) {
  std::vector<Eigen::Vector2d> points = table.points(key);
  for (const Eigen::Vector2d& point : points) {
    if (!(point.cwiseAbs().maxCoeff() <= kCoordinate.max)) {
      table.fail(key, fmt::format("has a point that is no place within {:.0f} m", kCoordinate.max));
    }
  }
  return points;
}

Pose2 read_pose(const TomlTable& table) {
  return {table.number("x", kCoordinate), table.number("y", kCoordinate),
          wrap_angle(table.number("theta", 0.0, kHeading))};
}

Fixture read_fixture(const TomlTable& table, double ceiling_height) {
  Fixture fixture = read_fixture_kind(table, ceiling_height);
  fixture.id = static_cast<int>(table.integer("id", {0, 1e9}));
  fixture.world_from_fixture = read_pose(table);
  table.reject_unknown();
  return fixture;
}

CeilingElement read_element(const TomlTable& table) {
  CeilingElement element;
  const std::string kind = table.choice("kind", "vent", {"vent", "detector", "speaker", "sign"});
  element.kind = kind == "vent"       ? ElementKind::kVent
                 : kind == "detector" ? ElementKind::kDetector
                 : kind == "speaker"  ? ElementKind::kSpeaker
                                      : ElementKind::kSign;
  element.world_from_element = read_pose(table);
  element.length = table.number("length", 0.6, {0.02, 5.0});
  element.width = table.number("width", element.length, {0.02, 5.0});
  table.reject_unknown();
  return element;
}

Hours read_hours(const TomlTable& table) {
  Hours hours;
  if (table.has("hours")) {
    const auto span = read_span(table.text("hours"));
    if (!span) {
      table.fail("hours", "must be two times of day that differ, as 08:00-12:00 or, over midnight, 22:00-06:00");
    }
    std::tie(hours.begin, hours.end) = *span;
  }
  if (table.has("days")) {
    const auto days = read_days(table.text("days"));
    if (!days) {
      table.fail("days", "must be days as Mo-Fr or Tu,Sa");
    }
    hours.days = *days;
  }
  return hours;
}

Zone read_zone(const TomlTable& table) {
  Zone zone;
  zone.name = table.text("name");
  const std::string kind = table.choice("kind", name_of(zone.kind), {"keep-out", "slow", "one-way", "quiet"});
  zone.kind = kind == "slow"      ? ZoneKind::kSlow
              : kind == "one-way" ? ZoneKind::kOneWay
              : kind == "quiet"   ? ZoneKind::kQuiet
                                  : ZoneKind::kKeepOut;
  zone.polygon = read_points(table, "polygon");
  if (!is_simple(zone.polygon)) {
    table.fail("polygon", "must be a list of at least three [x, y] corners in metres whose edges do not cross");
  }
  if (zone.kind == ZoneKind::kSlow) {
    zone.speed = table.number("speed", zone.speed, {0.05, 2.0});
  }
  if (zone.kind == ZoneKind::kOneWay) {
    zone.direction = wrap_angle(table.number("direction", kHeading));
  }
  zone.hours = read_hours(table);
  table.reject_unknown();
  return zone;
}

std::string pose_lines(const Pose2& pose) {
  return fmt::format("x = {:.3f}\ny = {:.3f}\ntheta = {:.4f}\n", pose.x, pose.y, pose.theta);
}

}  // namespace

std::string polygon_text(const Polygon& polygon) {
  std::string text;
  for (const Eigen::Vector2d& corner : polygon) {
    text += fmt::format("{}[{:.3f}, {:.3f}]", text.empty() ? "" : ", ", corner.x(), corner.y());
  }
  return "[" + text + "]";
}

std::string fixture_table(const Fixture& fixture, double ceiling_height) {
  std::string text = fmt::format("\n[[fixture]]\nid = {}\n", fixture.id);
  if (fixture.shape == FixtureShape::kRound) {
    text +=
        fmt::format("shape = \"round\"\n{}diameter = {:.3f}\n", pose_lines(fixture.world_from_fixture), fixture.length);
  } else {
    text += fixture.shape == FixtureShape::kSquare ? "shape = \"square\"\n" : "";
    text += fmt::format("{}length = {:.3f}\nwidth = {:.3f}\n", pose_lines(fixture.world_from_fixture), fixture.length,
                        fixture.width);
  }
  if (fixture.height != ceiling_height) {
    text += fmt::format("height = {:.3f}\n", fixture.height);
  }
  return text + fmt::format("lamps = {}\n", fixture.lamps);
}

Fixture read_fixture_kind(const TomlTable& table, double ceiling_height) {
  Fixture fixture;
  const std::string shape = table.choice("shape", "rectangle", {"rectangle", "square", "round"});
  if (shape == "round") {
    fixture.shape = FixtureShape::kRound;
    fixture.length = fixture.width = table.number("diameter", {0.05, 5.0});
  } else if (shape == "square") {
    fixture.shape = FixtureShape::kSquare;
    fixture.length = table.number("length", {0.05, 5.0});
    fixture.width = table.number("width", fixture.length, {0.05, 5.0});
    if (std::abs(fixture.width - fixture.length) > 0.005) {
      table.fail("width", "must equal length in a square fixture");
    }
  } else {
    fixture.length = table.number("length", {0.05, 10.0});
    fixture.width = table.number("width", {0.02, 5.0});
    if (fixture.width > fixture.length) {
      table.fail("width", "must not exceed length: theta is the direction of the long side");
    }
  }
  fixture.height = table.number("height", ceiling_height, {1.0, 30.0});
  fixture.lamps = table.count("lamps", 2, {1, 16});
  return fixture;
}

Building read_building(const std::filesystem::path& file) {
  return read_building_source(file).building;
}

BuildingSource read_building_source(const std::filesystem::path& file) {
  const TomlTable root = TomlTable::load(file);
  BuildingSource source;
  Building& building = source.building;
  building.name = root.text("name");
  building.ceiling_height = root.number("ceiling_height", {1.0, 30.0});
  building.map_file = root.path("map");
  const std::string search = root.choice("search", name_of(building.search), {"wander", "turn", "stand"});
  building.search = search == "wander"  ? SearchManner::kWander
                    : search == "stand" ? SearchManner::kStand
                                        : SearchManner::kTurn;
  building.is_complete = root.boolean("complete", building.is_complete);
  std::set<int> ids;
  for (const TomlTable& table : root.tables("fixture")) {
    building.fixtures.push_back(read_fixture(table, building.ceiling_height));
    source.fixture_lines.push_back(table.line());
    if (!ids.insert(building.fixtures.back().id).second) {
      table.fail("id", "is used twice, must be unique");
    }
  }
  for (const TomlTable& table : root.tables("element")) {
    building.elements.push_back(read_element(table));
  }
  for (const TomlTable& table : root.tables("window")) {
    building.windows.push_back({read_pose(table), table.number("width", 1.5, {0.1, 100.0})});
    table.reject_unknown();
  }
  for (const TomlTable& table : root.tables("door")) {
    building.doors.push_back(
        {static_cast<int>(table.integer("id", {0, 1e9})), read_pose(table), table.number("width", 0.9, {0.3, 10.0})});
    source.door_lines.push_back(table.line());
    table.reject_unknown();
  }
  for (const TomlTable& table : root.tables("place")) {
    building.places.push_back({table.text("name"), read_pose(table), table.has("theta")});
    source.place_lines.push_back(table.line());
    table.reject_unknown();
  }
  for (const TomlTable& table : root.tables("zone")) {
    building.zones.push_back(read_zone(table));
    source.zone_lines.push_back(table.line());
  }
  if (root.has("survey")) {
    const TomlTable table = root.table("survey");
    building.survey = SurveyAccuracy{table.number("position", {1e-4, 10.0}), table.number("heading", {1e-5, 1.0})};
    building.seen_from = read_points(table, "seen_from");
    table.reject_unknown();
  }
  root.reject_unknown();
  return source;
}

void write_building(const std::filesystem::path& file, const Building& building) {
  std::string text =
      fmt::format("# Metres and radians in the world frame of the map.\nname = {}\nceiling_height = {:.3f}\n",
                  quoted(building.name), building.ceiling_height);
  if (!building.map_file.empty()) {
    text += fmt::format("map = {}\n", quoted(building.map_file));
  }
  text += fmt::format("search = \"{}\"\n", name_of(building.search));
  text += building.is_complete ? "" : "complete = false  # a survey lists what was driven under\n";
  for (const Fixture& fixture : building.fixtures) {
    text += fixture_table(fixture, building.ceiling_height);
  }
  for (const CeilingElement& element : building.elements) {
    text += fmt::format("\n[[element]]\nkind = \"{}\"\n{}length = {:.3f}\nwidth = {:.3f}\n", name_of(element.kind),
                        pose_lines(element.world_from_element), element.length, element.width);
  }
  for (const Window& window : building.windows) {
    text += fmt::format("\n[[window]]\n{}width = {:.3f}\n", pose_lines(window.world_from_window), window.width);
  }
  for (const Door& door : building.doors) {
    text +=
        fmt::format("\n[[door]]\nid = {}\n{}width = {:.3f}\n", door.id, pose_lines(door.world_from_door), door.width);
  }
  for (const Place& place : building.places) {
    text +=
        fmt::format("\n[[place]]\nname = {}\nx = {:.3f}\ny = {:.3f}\n", quoted(place.name), place.pose.x, place.pose.y);
    text += place.has_theta ? fmt::format("theta = {:.4f}\n", place.pose.theta) : "";
  }
  for (const Zone& zone : building.zones) {
    text += fmt::format("\n[[zone]]\nname = {}\nkind = \"{}\"\npolygon = {}\n", quoted(zone.name), name_of(zone.kind),
                        polygon_text(zone.polygon));
    text += zone.kind == ZoneKind::kSlow ? fmt::format("speed = {:.3f}\n", zone.speed) : "";
    text += zone.kind == ZoneKind::kOneWay ? fmt::format("direction = {:.4f}\n", zone.direction) : "";
    const std::string span = span_text(zone.hours);
    const std::string days = days_text(zone.hours.days);
    text += span.empty() ? "" : fmt::format("hours = \"{}\"\n", span);
    text += days.empty() ? "" : fmt::format("days = \"{}\"\n", days);
  }
  if (building.survey) {
    text += fmt::format("\n[survey]  # 1-sigma of its fixtures\nposition = {:.4f}\nheading = {:.5f}\n",
                        building.survey->position, building.survey->heading);
    if (!building.seen_from.empty()) {
      text += fmt::format("seen_from = {}  # within 1 m of these places all lamps are listed\n",
                          polygon_text(building.seen_from));
    }
  }
  write_whole_file(file, text);
}

}  // namespace luminav
