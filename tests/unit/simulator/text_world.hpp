#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "drivers/simulator/world/world.hpp"
#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/building/map_file.hpp"

namespace luminav {

/// A map drawn as text, top row first: '#' wall, '.' free, ' ' unknown. Each letter is a square of `side` metres made
/// of cells of 5 cm; the lower left corner is the origin.
inline PriorMap map_from_text(const std::vector<std::string>& rows, double side = 0.5) {
  const int cells = static_cast<int>(side / 0.05 + 0.5);
  PriorMap map;
  map.geometry.resolution = 0.05;
  map.geometry.columns = static_cast<int>(rows.front().size()) * cells;
  map.geometry.rows = static_cast<int>(rows.size()) * cells;
  map.cells.resize(map.geometry.size());
  for (int row = 0; row < map.geometry.rows; ++row) {
    for (int column = 0; column < map.geometry.columns; ++column) {
      const std::string& line = rows[rows.size() - 1 - static_cast<std::size_t>(row / cells)];
      const char letter = line[static_cast<std::size_t>(column / cells)];
      map.cells[map.geometry.index({column, row})] = letter == '#'   ? Prior::kOccupied
                                                     : letter == '.' ? Prior::kFree
                                                                     : Prior::kUnknown;
    }
  }
  return map;
}

/// An empty hall with outer walls of one letter; `columns` x `rows` letters inside.
inline std::vector<std::string> hall(std::size_t columns, std::size_t rows) {
  std::vector<std::string> text(rows + 2, "#" + std::string(columns, '.') + "#");
  text.front() = text.back() = std::string(columns + 2, '#');
  return text;
}

/// The P3-DX's outline and its foremost sonars.
inline RobotDescription test_robot() {
  RobotDescription robot;
  robot.name = "p3dx";
  robot.footprint = {{0.21, -0.2125}, {0.21, 0.2125}, {-0.301, 0.2125}, {-0.301, -0.2125}};
  robot.sonar.robot_from_sonar = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.5 * kPi}};
  return robot;
}

/// A truth that is exactly what is believed: no spread at all.
inline WorldTruth exact_truth(PriorMap map, const Pose2& start) {
  WorldTruth truth;
  truth.walls = std::move(map);
  truth.robot = test_robot();
  truth.wheels.believed_base = truth.robot.wheel_base;
  truth.start = start;
  return truth;
}

/// A building in a folder of its own, with its map.
inline Building write_building(const std::string& name, const std::vector<std::string>& rows, double side = 0.5) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / ("luminav_simulator_" + name);
  std::filesystem::create_directories(folder);
  write_map(folder / "map.yaml", map_from_text(rows, side));
  Building building;
  building.name = name;
  building.map_file = (folder / "map.yaml").string();
  return building;
}

inline void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
}

}  // namespace luminav
