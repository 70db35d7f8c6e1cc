#include "tests/evaluation/mission_scenarios.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "drivers/simulator/shapes.hpp"
#include "drivers/simulator/world_truth.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "tests/evaluation/generated_worlds.hpp"
#include "tests/evaluation/map_score.hpp"
#include "tests/evaluation/run_report.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

constexpr int kFirstSeed = 1000;
constexpr double kGoalClearance = 0.5;  // [m]
constexpr double kRobotRadius = 0.30;   // [m] of the disc that says what can be reached
constexpr double kLeafDepth = 0.3;      // [m] of a closed door on the map
constexpr double kShortest = 4.0;       // [m] between two goals as the crow flies

struct Site {
  fs::path building_file;
  Building building;
  PriorMap map;
};

std::vector<Site> read_sites(const fs::path& generated) {
  const fs::path shipped = fs::path(LUMINAV_SOURCE_DIR) / "launch/buildings";
  std::vector<fs::path> files;
  for (const char* name : {"laboratory", "office", "symmetric-corridor"}) {
    files.push_back(shipped / name / "building.toml");
  }
  for (const fs::path& world : make_worlds(generated)) {
    if (world.stem() == "w5-panels" || world.stem() == "w6-mixed") {
      files.push_back(world.parent_path() / "building.toml");
    }
  }
  std::vector<Site> sites;
  for (const fs::path& file : files) {
    Site site{file, read_building(file), {}};
    site.map = read_map(site.building.map_file);
    sites.push_back(std::move(site));
  }
  return sites;
}

PriorMap with_door_closed(PriorMap map, const Door& door) {
  const Polygon leaf = rectangle(door.world_from_door, door.width + 0.2, kLeafDepth);
  for (int row = 0; row < map.geometry.rows; ++row) {
    for (int column = 0; column < map.geometry.columns; ++column) {
      if (distance(leaf, map.geometry.centre_of({column, row})) <= 0.0) {
        map.cells[map.geometry.index({column, row})] = Prior::kOccupied;
      }
    }
  }
  return map;
}

std::string mission_text(const Site& site, int index) {
  std::uint64_t generator = 0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(index + 1);
  const auto draw_place = [&](const std::optional<Eigen::Vector2d>& from) {
    Eigen::Vector2d place = draw_free_point(site.map, kGoalClearance, generator);
    for (int i = 0; from && i < 50 && (place - *from).norm() < kShortest; ++i) {
      place = draw_free_point(site.map, kGoalClearance, generator);
    }
    return place;
  };
  const Eigen::Vector2d start = draw_place(std::nullopt);
  std::string text =
      fmt::format("building = \"{}\"\nrobot = \"{}\"\nseed = {}\nduration = 2400\n\n", site.building_file.string(),
                  (fs::path(LUMINAV_SOURCE_DIR) / "launch/robots/p3dx.toml").string(), kFirstSeed + index);
  text += fmt::format("[start]\nx = {:.2f}\ny = {:.2f}\ntheta = {:.2f}\nknown = true\n\n[world]\ncalibrated = true\n",
                      start.x(), start.y(), wrap_angle(0.7 * index));
  for (int i = 0; i <= index % 3; ++i) {
    text += fmt::format("\n[[obstacle]]\nlength = {:.1f}\nwidth = {:.1f}\n", 0.4 + 0.2 * i, 0.4 + 0.1 * (index % 2));
  }
  for (int i = 0; index % 4 != 0 && i < 1 + index % 4; ++i) {
    text += fmt::format("\n[[person]]\nspeed = {:.1f}\n", 0.6 + 0.2 * i);
  }
  PriorMap closed = site.map;
  if (!site.building.doors.empty()) {
    const Door& door = site.building.doors[static_cast<std::size_t>(index) % site.building.doors.size()];
    closed = with_door_closed(std::move(closed), door);
    text += fmt::format("\n[[event]]\nat = 0.1\nkind = \"door\"\nid = {}\nopen = false\n", door.id);
  }
  Eigen::Vector2d last = start;
  for (int i = 0; i < kGoalsPerMission; ++i) {
    const Eigen::Vector2d goal = draw_place(last);
    const bool is_reachable = site.building.doors.empty() || octile_length(closed, start, goal, kRobotRadius) >= 0.0;
    text += fmt::format("\n[[goal]]\nx = {:.2f}\ny = {:.2f}\ntheta = {:.2f}\n{}", goal.x(), goal.y(),
                        wrap_angle(1.3 * index + 2.1 * i), is_reachable ? "" : "expect = \"refused\"\n");
    last = is_reachable ? goal : last;
  }
  return text;
}

}  // namespace

std::vector<fs::path> make_missions(const fs::path& folder) {
  const std::vector<Site> sites = read_sites(folder);
  fs::create_directories(folder / "missions");
  std::vector<fs::path> scenarios;
  for (int i = 0; i < kMissions; ++i) {
    scenarios.push_back(folder / "missions" / fmt::format("mission-{}.toml", kFirstSeed + i));
    write_whole_file(scenarios.back().string(), mission_text(sites[static_cast<std::size_t>(i) % sites.size()], i));
  }
  return scenarios;
}

}  // namespace luminav
