#include "tests/evaluation/runs/drawn_buildings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/whole_file.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

constexpr double kResolution = 0.05;  // [m] of the maps' cells

/// A building into whose solid block rooms and doors are carved.
class Drawing {
 public:
  Drawing(const char* name, double width, double depth, double ceiling_height) : ceiling_height_(ceiling_height) {
    building_.name = name;
    building_.search = SearchManner::kWander;
    building_.ceiling_height = ceiling_height;
    building_.map_file = "map.yaml";
    map_.geometry.resolution = kResolution;
    map_.geometry.columns = static_cast<int>(std::lround(width / kResolution));
    map_.geometry.rows = static_cast<int>(std::lround(depth / kResolution));
    map_.cells.assign(map_.geometry.size(), Prior::kOccupied);
  }

  /// Free space [m] between two corners.
  void carve(double west, double south, double east, double north) {
    const auto cell = [](double metres) { return static_cast<int>(std::lround(metres / kResolution)); };
    for (int row = cell(south); row < cell(north); ++row) {
      for (int column = cell(west); column < cell(east); ++column) {
        map_.cells[map_.geometry.index({column, row})] = Prior::kFree;
      }
    }
  }
  void hang(FixtureShape shape, double x, double y, double length, double width, double theta_deg = 0.0) {
    Fixture fixture;
    fixture.id = static_cast<int>(building_.fixtures.size()) + 1;
    fixture.shape = shape;
    fixture.world_from_fixture = {x, y, radians(theta_deg)};
    fixture.length = length;
    fixture.width = width;
    fixture.height = ceiling_height_;
    fixture.lamps = shape == FixtureShape::kRectangle ? 2 : 1;
    building_.fixtures.push_back(fixture);
  }
  void name_place(const char* name, double x, double y) { building_.places.push_back({name, {x, y, 0.0}, false}); }

  void write(const fs::path& home) const {
    fs::create_directories(home);
    write_map(home / "map.yaml", map_);
    write_building(home / "building.toml", building_);
  }

 private:
  double ceiling_height_;  // [m]
  Building building_;
  PriorMap map_;
};

/// Eight rooms along a corridor, each with a lamp like no other, most of the floor without one in view.
Drawing old_house() {
  Drawing house("old-house", 17.0, 11.8, 2.4);
  house.carve(0.3, 5.0, 16.7, 6.4);
  for (const double x : {2.4, 7.4, 12.4, 16.0}) {
    house.hang(FixtureShape::kRound, x, 5.7, 0.3, 0.3);
  }
  struct Room {
    double west, east, door;  // [m]
    FixtureShape shape;
    double x, length, width, theta_deg;
  };
  constexpr FixtureShape kRectangle = FixtureShape::kRectangle;
  constexpr FixtureShape kSquare = FixtureShape::kSquare;
  for (const Room& room :
       {Room{0.3, 4.2, 3.0, kRectangle, 2.1, 0.6, 0.2, 20.0}, Room{4.35, 9.0, 5.2, kSquare, 6.9, 0.4, 0.4, 10.0},
        Room{9.15, 12.5, 11.6, kRectangle, 10.8, 1.2, 0.3, 90.0},
        Room{12.65, 16.7, 13.6, kRectangle, 14.9, 0.9, 0.15, 0.0}}) {
    house.carve(room.west, 0.3, room.east, 4.85);
    house.carve(room.door - 0.5, 4.85, room.door + 0.5, 5.0);
    house.hang(room.shape, room.x, 2.6, room.length, room.width, room.theta_deg);
  }
  for (const Room& room : {Room{0.3, 5.4, 4.6, kRectangle, 2.9, 1.5, 0.2, 45.0},
                           Room{5.55, 8.6, 6.3, FixtureShape::kRound, 7.1, 0.5, 0.5, 0.0},
                           Room{8.75, 13.2, 12.4, kSquare, 10.9, 0.6, 0.6, 0.0},
                           Room{13.35, 16.7, 14.2, kRectangle, 15.1, 0.6, 0.3, 90.0}}) {
    house.carve(room.west, 6.55, room.east, 11.5);
    house.carve(room.door - 0.5, 6.4, room.door + 0.5, 6.55);
    house.hang(room.shape, room.x, 9.1, room.length, room.width, room.theta_deg);
  }
  house.name_place("study", 2.2, 1.6);
  house.name_place("parlour", 14.0, 2.0);
  house.name_place("kitchen", 10.0, 10.2);
  return house;
}

/// Rooms with two by two panels on both sides of a corridor, two of them double ones, and a nurses' station.
Drawing ward() {
  Drawing ward("ward", 46.0, 15.2, 2.7);
  ward.carve(0.3, 6.4, 45.7, 8.8);
  for (int i = 0; i < 15; ++i) {
    ward.hang(FixtureShape::kRound, 1.7 + 3.0 * i, 7.6, 0.25, 0.25);
  }
  constexpr double kWall = 0.2;
  const auto rooms = [&](double south, double door, const std::vector<double>& widths) {
    double west = 0.3;
    for (const double width : widths) {
      const double east = std::min(45.7, west + width);
      ward.carve(west, south, east, south + 5.9);
      ward.carve(west + 1.4, door, west + 2.6, door + kWall);
      for (double x = west + 0.9; x < east - 0.4; x += 2.2) {
        for (const double y : {south + 1.6, south + 4.0}) {
          ward.hang(FixtureShape::kSquare, x, y, 0.6, 0.6);
        }
      }
      west = east + kWall;
    }
  };
  rooms(0.3, 6.2, {4.0, 4.0, 4.0, 8.2, 4.0, 4.0, 4.0, 4.0, 6.4});
  rooms(9.0, 8.8, {6.4, 4.0, 4.0, 4.0, 4.0, 8.2, 4.0, 4.0, 4.0});
  ward.name_place("room-2", 6.0, 3.2);
  ward.name_place("station", 30.0, 11.8);
  ward.name_place("day-room", 42.0, 3.2);
  return ward;
}

/// Rooms with a bath's and a bed's downlights along an angled corridor, whose own ones stand unevenly.
Drawing hotel() {
  Drawing hotel("hotel", 34.0, 20.0, 2.5);
  const auto round = [&](double x, double y) { hotel.hang(FixtureShape::kRound, x, y, 0.2, 0.2); };
  hotel.carve(0.3, 5.6, 33.7, 7.4);
  hotel.carve(31.9, 7.4, 33.7, 19.7);
  for (const double x : {1.5, 4.0, 6.5, 9.5, 12.0, 14.5, 17.5, 20.0, 23.0, 25.5, 28.0, 30.5, 32.8}) {
    round(x, 6.5);
  }
  for (const double y : {9.0, 11.5, 14.5, 17.0, 19.0}) {
    round(32.8, y);
  }
  for (int i = 0; i < 7; ++i) {
    const double west = 0.3 + 4.5 * i;
    hotel.carve(west, 0.3, west + 4.35, 5.45);
    hotel.carve(west + 0.6, 5.45, west + 1.7, 5.6);
    round(west + 1.1, 4.5);
    round(west + 2.2 + 0.15 * (i % 3), 1.6);
    round(west + 3.4, 2.6 + 0.3 * (i % 2));
  }
  for (int i = 0; i < 6; ++i) {
    const double west = 0.3 + 5.2 * i;
    hotel.carve(west, 7.55, west + 5.05, 13.4);
    hotel.carve(west + 3.4, 7.4, west + 4.5, 7.55);
    round(west + 3.9, 8.7);
    round(west + 1.3, 9.6 + 0.25 * (i % 2));
    round(west + 3.1, 11.6 - 0.2 * (i % 3));
  }
  hotel.name_place("room-1", 2.4, 2.6);
  hotel.name_place("stairs", 32.8, 18.0);
  hotel.name_place("room-12", 18.0, 10.6);
  return hotel;
}

std::string scenario_text(const fs::path& building_file, double duration, std::initializer_list<const char*> places) {
  std::string text = fmt::format(
      "building = \"{}\"\nrobot = \"{}\"\nseed = 1\nduration = {:.0f}\n\n[lighting]\ndaylight = 0.5\n\n"
      "[[obstacle]]\nlength = 0.6\nwidth = 0.4\n\n[[person]]\nspeed = 0.8\n",
      building_file.string(), (fs::path(LUMINAV_SOURCE_DIR) / "launch/robots/p3dx.toml").string(), duration);
  for (const char* place : places) {
    text += fmt::format("\n[[goal]]\nplace = \"{}\"\n", place);
  }
  return text;
}

std::string house_text() {
  return scenario_text("building.toml", 1200.0, {"study", "parlour", "kitchen"});
}
std::string ward_text() {
  return scenario_text("building.toml", 1500.0, {"room-2", "station", "day-room"});
}
std::string laboratory_text() {
  return scenario_text(fs::path(LUMINAV_SOURCE_DIR) / "launch/buildings/laboratory/building.toml", 900.0,
                       {"workbench", "office-3", "east-corridor"});
}

/// The fixture hangs so far [m, deg] from where the file has it.
std::string moved(int id, double dx, double dy, double dtheta_deg = 0.0) {
  return fmt::format("\n[[event]]\nkind = \"lamp\"\nat = 0\nid = {}\ndx = {}\ndy = {}\ndtheta = {:.4f}\n", id, dx, dy,
                     radians(dtheta_deg));
}

std::string every(double period, double duration, std::string_view event) {
  std::string text;
  for (double at = period; at < duration; at += period) {
    text += fmt::format("\n[[event]]\nat = {:.0f}\n{}", at, event);
  }
  return text;
}

}  // namespace

std::vector<fs::path> make_drawn_buildings(const fs::path& folder) {
  struct Drawn {
    const char* name;
    Drawing drawing;
    std::string scenario;
  };
  std::vector<fs::path> scenarios;
  for (const Drawn& drawn :
       {Drawn{"old-house", old_house(), house_text()}, Drawn{"ward", ward(), ward_text()},
        Drawn{"hotel", hotel(), scenario_text("building.toml", 1200.0, {"room-1", "stairs", "room-12"})}}) {
    drawn.drawing.write(folder / drawn.name);
    scenarios.push_back(folder / drawn.name / fmt::format("{}.toml", drawn.name));
    write_whole_file(scenarios.back().string(), drawn.scenario);
  }
  return scenarios;
}

std::vector<fs::path> make_mishaps(const fs::path& folder) {
  make_drawn_buildings(folder);
  const fs::path laboratory = folder / "laboratory-mishaps";
  fs::create_directories(laboratory);
  std::vector<fs::path> scenarios;
  const auto add = [&](const fs::path& home, const char* name, const std::string& text) {
    scenarios.push_back(home / fmt::format("{}.toml", name));
    write_whole_file(scenarios.back().string(), text);
  };
  std::string corridor_off;
  for (int id = 27; id <= 34; ++id) {
    corridor_off += moved(id, 0.2, 0.0);
  }
  add(folder / "old-house", "house-one-off", house_text() + moved(2, 0.4, 0.0));
  add(folder / "old-house", "house-four-off",
      house_text() + moved(3, 0.4, 0.0) + moved(5, 0.0, -0.4) + moved(7, -0.3, 0.25) + moved(10, 0.28, 0.28));
  add(folder / "ward", "ward-four-off",
      ward_text() + moved(7, 0.4, 0.0) + moved(18, 0.0, -0.4) + moved(36, -0.3, 0.25) + moved(44, 0.28, 0.28));
  add(laboratory, "laboratory-four-off",
      laboratory_text() + moved(7, 0.4, 0.0) + moved(22, -0.3, 0.25) + moved(28, 0.0, -0.4) + moved(31, 0.28, 0.28));
  add(laboratory, "laboratory-row-off", laboratory_text() + corridor_off);
  add(laboratory, "laboratory-turned", laboratory_text() + moved(29, 0.0, 0.0, 90.0));
  add(laboratory, "laboratory-slips",
      laboratory_text() + every(15.0, 900.0, "kind = \"slip\"\nfactor = 0.5\nduration = 3\n"));
  add(laboratory, "laboratory-bumps",
      laboratory_text() + every(25.0, 900.0, "kind = \"bump\"\ndx = 0.1\ndy = 0.1\ndtheta = 0.21\n"));
  return scenarios;
}

}  // namespace luminav
