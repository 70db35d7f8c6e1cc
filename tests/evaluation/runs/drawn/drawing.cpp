#include "tests/evaluation/runs/drawn/drawing.hpp"

#include <fmt/format.h>

#include <cmath>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"

namespace luminav {

namespace fs = std::filesystem;

namespace {

constexpr double kResolution = 0.05;  // [m] of the maps' cells

}  // namespace

Drawing::Drawing(const char* name, double width, double depth, double ceiling_height) {
  building_.name = name;
  building_.search = SearchManner::kWander;
  building_.ceiling_height = ceiling_height;
  building_.map_file = "map.yaml";
  map_.geometry.resolution = kResolution;
  map_.geometry.columns = static_cast<int>(std::lround(width / kResolution));
  map_.geometry.rows = static_cast<int>(std::lround(depth / kResolution));
  map_.cells.assign(map_.geometry.size(), Prior::kOccupied);
}

void Drawing::fill(double west, double south, double east, double north, Prior prior) {
  const auto cell = [](double metres) { return static_cast<int>(std::lround(metres / kResolution)); };
  for (int row = cell(south); row < cell(north); ++row) {
    for (int column = cell(west); column < cell(east); ++column) {
      map_.cells[map_.geometry.index({column, row})] = prior;
    }
  }
}

void Drawing::carve(double west, double south, double east, double north) {
  fill(west, south, east, north, Prior::kFree);
}

void Drawing::build(double west, double south, double east, double north) {
  fill(west, south, east, north, Prior::kOccupied);
}

void Drawing::hang(FixtureShape shape, double x, double y, double length, double width, double theta_deg,
                   double height) {
  Fixture fixture;
  fixture.id = static_cast<int>(building_.fixtures.size()) + 1;
  fixture.shape = shape;
  fixture.world_from_fixture = {x, y, radians(theta_deg)};
  fixture.length = length;
  fixture.width = width;
  fixture.height = height > 0.0 ? height : building_.ceiling_height;
  fixture.lamps = shape == FixtureShape::kRectangle ? 2 : 1;
  building_.fixtures.push_back(fixture);
}

void Drawing::hang_grid(FixtureShape shape, const Grid& grid, double length, double width, double theta_deg,
                        double height) {
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      hang(shape, grid.x + column * grid.dx, grid.y + row * grid.dy, length, width, theta_deg, height);
    }
  }
}

void Drawing::name_place(const char* name, double x, double y) {
  building_.places.push_back({name, {x, y, 0.0}, false});
}

void Drawing::write(const fs::path& home) const {
  fs::create_directories(home);
  write_map(home / "map.yaml", map_);
  write_building(home / "building.toml", building_);
}

std::string drawn_scenario(const fs::path& building_file, double duration, std::initializer_list<const char*> places) {
  std::string text = fmt::format(
      "building = \"{}\"\nrobot = \"{}\"\nseed = 1\nduration = {:.0f}\n\n[lighting]\ndaylight = 0.5\n\n"
      "[[obstacle]]\nlength = 0.6\nwidth = 0.4\n\n[[person]]\nspeed = 0.8\n",
      building_file.string(), (fs::path(LUMINAV_SOURCE_DIR) / "launch/robots/p3dx.toml").string(), duration);
  for (const char* place : places) {
    text += fmt::format("\n[[goal]]\nplace = \"{}\"\n", place);
  }
  return text;
}

}  // namespace luminav
