#include <fmt/format.h>

#include <filesystem>
#include <limits>

#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/shipped_file.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/option_values.hpp"
#include "services/surveyor/floor_plan.hpp"

namespace {

using namespace luminav;
namespace fs = std::filesystem;

struct Request {
  std::string out;
  std::string size = "60x40";
  std::string kind = "tubes";
  std::string map;
  std::string robot = shipped_file("robots/p3dx.toml");
  std::int64_t seed = 1;
  FloorPlanParams params;
};

FixtureKind kind_named(const std::string& name) {
  if (name == "tubes") {
    return FixtureKind::kTubes;
  }
  if (name == "panels") {
    return FixtureKind::kPanels;
  }
  if (name == "downlights") {
    return FixtureKind::kDownlights;
  }
  if (name == "mixed") {
    return FixtureKind::kMixed;
  }
  throw ConfigurationError(fmt::format("--kind = {}, must be tubes, panels, downlights or mixed", name));
}

FloorPlanParams params_of(const Request& request) {
  FloorPlanParams params = request.params;
  const std::size_t cross = request.size.find('x');
  const std::string depth = cross == std::string::npos ? "" : request.size.substr(cross + 1);
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  params.width = read_number(request.size.substr(0, cross)).value_or(kNone);
  params.depth = read_number(depth).value_or(kNone);
  if (!(params.width <= 400.0 && params.depth <= 400.0)) {
    throw ConfigurationError(fmt::format("--size = {}, must be WIDTHxDEPTH in metres, at most 400x400", request.size));
  }
  check_option("--pitch", params.pitch, {1.5, 10.0});
  check_option("--ceiling", params.ceiling_height, {1.0, 30.0});  // as read_building allows
  check_option("--irregularity", params.irregularity, kFraction);
  params.kind = kind_named(request.kind);
  params.seed = static_cast<std::uint64_t>(request.seed);
  const fs::path folder = fs::absolute(request.out).lexically_normal();  // "hall/" ends in an empty name
  params.name = (folder.has_filename() ? folder : folder.parent_path()).filename().string();
  return params;
}

/// A demo in the new building: three of its places as goals, a box and a person drawn by the simulator's seed.
std::string scenario_text(const Request& request, const Building& building, const fs::path& folder) {
  std::string text = fmt::format("building = \"building.toml\"\nrobot = \"{}\"\nseed = {}\nduration = 1800\n",
                                 fs::relative(request.robot, folder).string(), request.seed);
  const std::size_t places = building.places.size();
  for (const std::size_t i : {places / 4, places / 2, places - 1}) {
    text += fmt::format("\n[[goal]]\nplace = \"{}\"\n", building.places[i].name);
  }
  return text;
}

int make(const Request& request) {
  const FloorPlanParams params = params_of(request);
  FloorPlan plan = request.map.empty() ? make_floor_plan(params) : light_map(read_map(request.map), params);
  const fs::path folder = fs::absolute(request.out);
  if (fs::exists(folder / "building.toml")) {
    throw std::runtime_error(fmt::format("{}: is there already", (folder / "building.toml").string()));
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw std::runtime_error(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  }
  write_map(folder / "map.yaml", plan.map);
  plan.building.map_file = "map.yaml";
  write_building(folder / "building.toml", plan.building);
  fmt::print("{}: {} fixtures, {} elements, {} doors, {} places on {:.0f} x {:.0f} m\n",
             (folder / "building.toml").string(), plan.building.fixtures.size(), plan.building.elements.size(),
             plan.building.doors.size(), plan.building.places.size(),
             plan.map.geometry.columns * plan.map.geometry.resolution,
             plan.map.geometry.rows * plan.map.geometry.resolution);
  if (!plan.building.places.empty()) {
    write_whole_file(folder / "scenario.toml", scenario_text(request, plan.building, folder));
    fmt::print("drive in it: scripts/demo --scenario {}\n", (folder / "scenario.toml").string());
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  std::vector<std::string> out;
  CommandLine line("make-building",
                   "Makes a plausible office floor with its ceiling, or hangs fixtures into a given map.");
  line.positional("folder", out, "new folder for building.toml, map.yaml and scenario.toml", true)
      .text("--size", request.size, "WIDTHxDEPTH [m]")
      .number("--pitch", request.params.pitch, "between neighbouring fixtures [m]")
      .text("--kind", request.kind, "tubes, panels, downlights or mixed")
      .number("--irregularity", request.params.irregularity,
              "0 = all alike .. 1 = shifted, missing and turned fixtures")
      .number("--ceiling", request.params.ceiling_height, "height [m]")
      .integer("--seed", request.seed, "same seed, same building")
      .text("--map", request.map, "hang fixtures over the free space of this map (ROS map_server YAML) instead")
      .text("--robot", request.robot, "robot of the scenario");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return run_guarded("make-building", [&] {
    if (out.size() != 1) {
      throw ConfigurationError("needs one folder");
    }
    request.out = out.front();
    return make(request);
  });
}
