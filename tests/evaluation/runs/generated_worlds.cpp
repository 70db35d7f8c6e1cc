#include "tests/evaluation/runs/generated_worlds.hpp"

#include <fmt/format.h>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/surveyor/floor_plan.hpp"

namespace luminav {
namespace {

namespace fs = std::filesystem;

/// Three goals spread over the floor, a box that the map does not know and somebody who walks.
std::string scenario_text(const Building& building, double duration) {
  std::string text = fmt::format(
      "building = \"building.toml\"\nrobot = \"{}\"\nseed = 1\nduration = {:.0f}\n\n[lighting]\ndaylight = 0.5\n\n"
      "[[obstacle]]\nlength = 0.6\nwidth = 0.4\n\n[[person]]\nspeed = 0.8\n",
      (fs::path(LUMINAV_SOURCE_DIR) / "launch/robots/p3dx.toml").string(), duration);
  const std::size_t places = building.places.size();
  for (const std::size_t i : {places / 4, places / 2, places - 1}) {
    text += fmt::format("\n[[goal]]\nplace = \"{}\"\n", building.places[i].name);
  }
  return text;
}

/// Folder/NAME/NAME.toml with its building; what is there from before is replaced by the same.
fs::path write_world(const fs::path& folder, const FloorPlanParams& params, double duration) {
  const fs::path home = folder / params.name;
  fs::create_directories(home);
  FloorPlan plan = make_floor_plan(params);
  write_map(home / "map.yaml", plan.map);
  plan.building.map_file = "map.yaml";
  write_building(home / "building.toml", plan.building);
  const fs::path scenario = home / (params.name + ".toml");
  write_whole_file(scenario.string(), scenario_text(plan.building, duration));
  return scenario;
}

FloorPlanParams floor(const char* name, double pitch, FixtureKind kind, double ceiling_height) {
  FloorPlanParams params;
  params.name = name;
  params.width = 30.0;
  params.depth = 22.0;
  params.pitch = pitch;
  params.kind = kind;
  params.ceiling_height = ceiling_height;
  params.seed = 7;
  return params;
}

}  // namespace

std::vector<fs::path> make_worlds(const fs::path& folder) {
  const fs::path shipped = fs::path(LUMINAV_SOURCE_DIR) / "launch/scenarios";
  std::vector<fs::path> scenarios{shipped / "laboratory.toml", shipped / "symmetric-corridor.toml"};
  // The camera sits 0.3 m above the floor.
  for (const FloorPlanParams& params :
       {floor("w3-dense", 1.8, FixtureKind::kTubes, 2.8), floor("w4-sparse", 4.0, FixtureKind::kTubes, 2.8),
        floor("w5-panels", 2.8, FixtureKind::kPanels, 2.8), floor("w6-mixed", 2.8, FixtureKind::kMixed, 2.8),
        floor("w7-high", 2.8, FixtureKind::kTubes, 3.5), floor("w8-low", 2.8, FixtureKind::kTubes, 2.1)}) {
    scenarios.push_back(write_world(folder, params, 1500.0));
  }
  return scenarios;
}

std::vector<fs::path> make_scale_series(const fs::path& folder) {
  struct Size {
    const char* name;
    double width;  // [m]
    double depth;  // [m]
  };
  std::vector<fs::path> scenarios;
  for (const Size& size : {Size{"scale-40", 24.0, 16.0}, Size{"scale-130", 42.0, 28.0}, Size{"scale-400", 72.0, 50.0},
                           Size{"scale-1300", 130.0, 90.0}, Size{"scale-4000", 230.0, 155.0}}) {
    FloorPlanParams params;
    params.name = size.name;
    params.width = size.width;
    params.depth = size.depth;
    params.seed = 11;
    scenarios.push_back(write_world(folder, params, 1800.0 + 6.0 * (size.width + size.depth)));
  }
  return scenarios;
}

}  // namespace luminav
