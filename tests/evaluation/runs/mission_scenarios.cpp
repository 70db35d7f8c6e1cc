#include "tests/evaluation/runs/mission_scenarios.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <vector>

#include "drivers/simulator/geometry/shapes.hpp"
#include "drivers/simulator/world/free_space.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "tests/evaluation/judge/map_score.hpp"
#include "tests/evaluation/report/run_report.hpp"
#include "tests/evaluation/runs/generated_worlds.hpp"

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
  FreeSpace free;
};

std::vector<Site> read_sites(const fs::path& generated) {
  const fs::path shipped = fs::path(LUMINAV_SOURCE_DIR) / "launch/buildings";
  std::vector<fs::path> files;
  // Not the symmetric corridor: whoever says where the robot starts there only adds a hypothesis, and to its twin
  // nothing that is seen ever objects.
  for (const char* name : {"laboratory", "office"}) {
    files.push_back(shipped / name / "building.toml");
  }
  for (const fs::path& world : make_worlds(generated)) {
    if (world.stem() == "w3-dense" || world.stem() == "w5-panels" || world.stem() == "w6-mixed") {
      files.push_back(world.parent_path() / "building.toml");
    }
  }
  std::vector<Site> sites;
  for (const fs::path& file : files) {
    Building building = read_building(file);
    PriorMap map = read_map(building.map_file);
    FreeSpace free(map);
    sites.push_back({file, std::move(building), std::move(map), std::move(free)});
  }
  return sites;
}

struct ClosedDoor {
  int id = 0;
  Polygon leaf;
};

PriorMap with(const ClosedDoor& door, PriorMap map) {
  for (int row = 0; row < map.geometry.rows; ++row) {
    for (int column = 0; column < map.geometry.columns; ++column) {
      if (distance(door.leaf, map.geometry.centre_of({column, row})) <= 0.0) {
        map.cells[map.geometry.index({column, row})] = Prior::kOccupied;
      }
    }
  }
  return map;
}

std::string obstacles_and_people(int index) {
  std::string text;
  for (int i = 0; i <= index % 3; ++i) {
    text += fmt::format("\n[[obstacle]]\nlength = {:.1f}\nwidth = {:.1f}\n", 0.4 + 0.2 * i, 0.4 + 0.1 * (index % 2));
  }
  for (int i = 0; index % 4 != 0 && i < 1 + index % 4; ++i) {
    text += fmt::format("\n[[person]]\nspeed = {:.1f}\n", 0.6 + 0.2 * i);
  }
  return text;
}

/// A start, obstacles and people, a door that is closed, and goals; what the door cuts off must be refused.
std::string mission_text(const Site& site, int index) {
  std::optional<ClosedDoor> closed;
  if (const auto& doors = site.building.doors; !doors.empty()) {
    const Door& door = doors[static_cast<std::size_t>(index) % doors.size()];
    closed = {door.id, rectangle(door.world_from_door, door.width + 0.2, kLeafDepth)};
  }
  SplitMix generator(0x9e3779b97f4a7c15ULL * static_cast<std::uint64_t>(index + 1));
  const auto draw_place = [&](const std::optional<Eigen::Vector2d>& from) {
    // neither close to where the robot stands nor so close to the closed door that nobody could say on which side
    const auto is_bad = [&](const Eigen::Vector2d& place) {
      return (from && (place - *from).norm() < kShortest) || (closed && distance(closed->leaf, place) < kGoalClearance);
    };
    Eigen::Vector2d place = site.free.draw_point(kGoalClearance, generator);
    for (int i = 0; i < 100 && is_bad(place); ++i) {
      place = site.free.draw_point(kGoalClearance, generator);
    }
    return place;
  };
  const Eigen::Vector2d start = draw_place(std::nullopt);
  const std::vector<bool> reachable = reachable_cells(closed ? with(*closed, site.map) : site.map, start, kRobotRadius);
  std::string text =
      fmt::format("building = \"{}\"\nrobot = \"{}\"\nseed = {}\nduration = 2400\n\n", site.building_file.string(),
                  (fs::path(LUMINAV_SOURCE_DIR) / "launch/robots/p3dx.toml").string(), kFirstSeed + index);
  text += fmt::format("[start]\nx = {:.2f}\ny = {:.2f}\ntheta = {:.2f}\nknown = true\n\n[world]\ncalibrated = true\n",
                      start.x(), start.y(), wrap_angle(0.7 * index));
  text += obstacles_and_people(index);
  if (closed) {
    text += fmt::format("\n[[event]]\nat = 0.1\nkind = \"door\"\nid = {}\nopen = false\n", closed->id);
  }
  Eigen::Vector2d last = start;
  for (int i = 0; i < kGoalsPerMission; ++i) {
    const Eigen::Vector2d goal = draw_place(last);
    const bool is_reachable = reachable[site.map.geometry.index(site.map.geometry.cell_at(goal))];
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
