#include "tests/evaluation/runs/drawn/drawn_buildings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <vector>

#include "services/common/configuration/whole_file.hpp"
#include "tests/evaluation/runs/drawn/drawing.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

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

/// One open floor with columns, a core of lifts and two glazed boxes: panels in one grid, but where those stand.
Drawing open_plan() {
  Drawing floor("open-plan", 34.0, 22.6, 2.8);
  floor.carve(0.3, 0.3, 33.7, 22.3);
  floor.build(13.0, 9.0, 19.0, 14.0);
  for (const double x : {7.0, 25.0}) {
    for (const double y : {6.0, 16.0}) {
      floor.build(x - 0.25, y - 0.25, x + 0.25, y + 0.25);
    }
  }
  floor.build(26.4, 16.4, 33.7, 16.5);
  floor.build(26.4, 16.5, 26.5, 20.6);
  floor.build(0.3, 3.3, 5.9, 3.4);
  floor.build(5.8, 1.6, 5.9, 3.3);
  floor.hang_grid(FixtureShape::kSquare, {1.6, 2.0, 2.8, 2.6, 12, 3}, 0.6, 0.6);
  floor.hang_grid(FixtureShape::kSquare, {1.6, 9.8, 2.8, 2.6, 4, 2}, 0.6, 0.6);
  floor.hang_grid(FixtureShape::kSquare, {21.2, 9.8, 2.8, 2.6, 5, 2}, 0.6, 0.6);
  floor.hang_grid(FixtureShape::kSquare, {1.6, 15.0, 2.8, 2.6, 9, 3}, 0.6, 0.6);
  floor.hang_grid(FixtureShape::kRectangle, {28.2, 17.6, 2.2, 2.8, 3, 2}, 1.2, 0.3, 90.0);
  floor.name_place("desk", 10.0, 5.0);
  floor.name_place("kitchen", 23.0, 19.0);
  floor.name_place("meeting", 30.0, 18.8);
  return floor;
}

/// Classrooms with three by two tubes on both sides of a corridor, and a hall under a higher ceiling of its own.
Drawing school() {
  Drawing school("school", 48.0, 17.4, 2.9);
  constexpr double kHallHeight = 4.2;
  school.carve(0.3, 7.3, 47.7, 9.7);
  school.hang_grid(FixtureShape::kRectangle, {1.8, 8.5, 3.4, 0.0, 14, 1}, 1.2, 0.15);
  for (const double south : {0.3, 9.9}) {
    for (int i = 0; i < (south < 1.0 ? 6 : 4); ++i) {
      const double west = 0.3 + 7.9 * i;
      school.carve(west, south, west + 7.7, south + 6.8);
      school.carve(west + 5.8, south < 1.0 ? 7.1 : 9.7, west + 6.9, south < 1.0 ? 7.3 : 9.9);
      school.hang_grid(FixtureShape::kRectangle, {west + 1.5, south + 2.0, 2.3, 2.8, 3, 2}, 1.5, 0.25, 90.0);
    }
  }
  school.carve(32.1, 9.9, 47.7, 17.1);
  school.carve(38.0, 9.7, 40.0, 9.9);
  school.hang_grid(FixtureShape::kSquare, {34.2, 11.8, 3.8, 3.4, 4, 2}, 1.0, 1.0, 0.0, kHallHeight);
  school.name_place("class-2", 11.0, 4.0);
  school.name_place("hall", 42.0, 13.4);
  school.name_place("class-9", 27.0, 13.0);
  return school;
}

/// Sixty metres of equal lamps; at one end a square one.
Drawing long_corridor() {
  Drawing corridor("long-corridor", 60.6, 2.8, 2.5);
  corridor.carve(0.3, 0.3, 60.3, 2.5);
  corridor.hang_grid(FixtureShape::kRectangle, {1.8, 1.4, 3.0, 0.0, 19, 1}, 1.2, 0.3);
  corridor.hang(FixtureShape::kSquare, 58.8, 1.4, 0.6, 0.6);
  corridor.name_place("west", 4.0, 1.4);
  corridor.name_place("middle", 30.0, 1.4);
  corridor.name_place("east", 57.0, 1.4);
  return corridor;
}

/// Ten equal rooms off a corridor whose lamps keep step with them; one end of it has a room of its own.
Drawing cells() {
  Drawing cells("cells", 46.2, 9.4, 2.6);
  cells.carve(0.3, 5.7, 45.9, 7.5);
  for (int i = 0; i < 10; ++i) {
    const double west = 0.3 + 4.2 * i;
    cells.carve(west, 0.3, west + 4.0, 5.5);
    cells.carve(west + 0.5, 5.5, west + 1.5, 5.7);
    cells.hang_grid(FixtureShape::kRectangle, {west + 2.0, 1.7, 0.0, 2.4, 1, 2}, 1.2, 0.3);
    cells.hang(FixtureShape::kRound, west + 1.0, 6.6, 0.3, 0.3);
  }
  cells.carve(42.3, 0.3, 45.9, 9.1);
  cells.hang_grid(FixtureShape::kSquare, {44.1, 1.8, 0.0, 2.6, 1, 3}, 0.6, 0.6);
  cells.name_place("cell-2", 6.6, 2.6);
  cells.name_place("cell-8", 31.8, 2.6);
  cells.name_place("store", 44.1, 2.4);
  return cells;
}

/// Halls round a court that no door leads to, each lit in its own way and some of them in the same.
Drawing museum() {
  Drawing museum("museum", 32.0, 26.0, 3.2);
  struct Hall {
    double west, south, east, north;  // [m]
    FixtureShape shape;
    Drawing::Grid grid;
    double length, width, theta_deg;
  };
  constexpr FixtureShape kRectangle = FixtureShape::kRectangle;
  constexpr FixtureShape kSquare = FixtureShape::kSquare;
  constexpr FixtureShape kRound = FixtureShape::kRound;
  for (const Hall& hall : {Hall{0.3, 0.3, 9.3, 9.3, kRound, {2.0, 2.0, 2.8, 2.8, 3, 3}, 0.4, 0.4, 0.0},
                           Hall{9.6, 0.3, 22.4, 7.3, kRectangle, {11.2, 2.2, 3.2, 3.2, 4, 2}, 1.5, 0.2, 0.0},
                           Hall{22.7, 0.3, 31.7, 9.3, kRound, {24.4, 2.0, 2.8, 2.8, 3, 3}, 0.4, 0.4, 0.0},
                           Hall{24.7, 9.6, 31.7, 16.4, kSquare, {26.2, 11.4, 3.4, 3.2, 2, 2}, 1.0, 1.0, 0.0},
                           Hall{22.7, 16.7, 31.7, 25.7, kRound, {24.4, 18.4, 2.8, 2.8, 3, 3}, 0.4, 0.4, 0.0},
                           Hall{9.6, 18.7, 22.4, 25.7, kRectangle, {11.2, 20.6, 3.2, 3.2, 4, 2}, 1.5, 0.2, 0.0},
                           Hall{0.3, 16.7, 9.3, 25.7, kRectangle, {2.2, 18.6, 2.6, 2.6, 3, 3}, 1.2, 0.3, 45.0},
                           Hall{0.3, 9.6, 7.3, 16.4, kSquare, {1.8, 11.4, 3.4, 3.2, 2, 2}, 1.0, 1.0, 0.0}}) {
    museum.carve(hall.west, hall.south, hall.east, hall.north);
    museum.hang_grid(hall.shape, hall.grid, hall.length, hall.width, hall.theta_deg);
  }
  for (const double x : {9.3, 22.4}) {
    museum.carve(x, 3.0, x + 0.3, 4.8);
    museum.carve(x, 21.4, x + 0.3, 23.2);
  }
  for (const double y : {9.3, 16.4}) {
    museum.carve(2.6, y, 4.4, y + 0.3);
    museum.carve(27.4, y, 29.2, y + 0.3);
  }
  museum.name_place("entrance", 16.0, 2.6);
  museum.name_place("moderns", 28.0, 13.0);
  museum.name_place("masters", 5.0, 21.0);
  return museum;
}

}  // namespace

std::vector<fs::path> make_drawn_buildings(const fs::path& folder) {
  std::vector<fs::path> scenarios;
  const auto add = [&](const char* name, const Drawing& drawing, double duration,
                       std::initializer_list<const char*> places) {
    drawing.write(folder / name);
    scenarios.push_back(folder / name / fmt::format("{}.toml", name));
    write_whole_file(scenarios.back().string(), drawn_scenario("building.toml", duration, places));
  };
  add("old-house", old_house(), 1200.0, {"study", "parlour", "kitchen"});
  add("ward", ward(), 1500.0, {"room-2", "station", "day-room"});
  add("hotel", hotel(), 1200.0, {"room-1", "stairs", "room-12"});
  add("open-plan", open_plan(), 1200.0, {"desk", "kitchen", "meeting"});
  add("school", school(), 1500.0, {"class-2", "hall", "class-9"});
  add("long-corridor", long_corridor(), 1500.0, {"west", "middle", "east"});
  add("cells", cells(), 1500.0, {"cell-2", "cell-8", "store"});
  add("museum", museum(), 1200.0, {"entrance", "moderns", "masters"});
  return scenarios;
}

}  // namespace luminav
