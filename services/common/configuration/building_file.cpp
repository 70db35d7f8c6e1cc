#include "services/common/configuration/building_file.hpp"

#include <set>

#include "services/common/configuration/toml_table.hpp"

namespace luminav {
namespace {

constexpr Range kCoordinate{-1e5, 1e5};
constexpr Range kHeading{-7.0, 7.0};  // a full turn either way is accepted and wrapped

Pose2 read_pose(const TomlTable& table) {
  return {table.number("x", kCoordinate), table.number("y", kCoordinate),
          wrap_angle(table.number("theta", 0.0, kHeading))};
}

Fixture read_fixture(const TomlTable& table, double ceiling_height) {
  Fixture fixture;
  fixture.id = static_cast<int>(table.integer("id", {0, 1e9}));
  const std::string shape = table.choice("shape", "rectangle", {"rectangle", "square", "round"});
  fixture.world_from_fixture = read_pose(table);
  if (shape == "round") {
    fixture.shape = FixtureShape::kRound;
    fixture.length = fixture.width = table.number("diameter", {0.05, 5.0});
  } else if (shape == "square") {
    fixture.shape = FixtureShape::kSquare;
    fixture.length = table.number("length", {0.05, 5.0});
    fixture.width = table.number("width", fixture.length, {0.05, 5.0});
  } else {
    fixture.length = table.number("length", {0.05, 10.0});
    fixture.width = table.number("width", {0.02, 5.0});
    if (fixture.width > fixture.length) {
      table.fail("width", "must not exceed length: theta is the direction of the long side");
    }
  }
  fixture.height = table.number("height", ceiling_height, {1.0, 30.0});
  fixture.lamps = table.count("lamps", 2, {1, 16});
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

}  // namespace

Building read_building(const std::filesystem::path& file) {
  const TomlTable root = TomlTable::load(file);
  Building building;
  building.name = root.text("name");
  building.ceiling_height = root.number("ceiling_height", {1.0, 30.0});
  building.map_file = root.path("map");
  std::set<int> ids;
  for (const TomlTable& table : root.tables("fixture")) {
    building.fixtures.push_back(read_fixture(table, building.ceiling_height));
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
    table.reject_unknown();
  }
  for (const TomlTable& table : root.tables("place")) {
    building.places.push_back({table.text("name"), read_pose(table), table.has("theta")});
    table.reject_unknown();
  }
  root.reject_unknown();
  return building;
}

}  // namespace luminav
