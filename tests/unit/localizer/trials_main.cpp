// Drives a synthetic robot through a building many times and reports how well it finds and keeps its pose.
// Not part of the test run: localizer_trials --building launch/buildings/laboratory/building.toml --runs 200

#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "services/common/process/command_line.hpp"
#include "services/localizer/localizer_config.hpp"
#include "tests/unit/localizer/trial_summary.hpp"

namespace luminav::testing {
namespace {

struct Request {
  std::string robot = std::string(LUMINAV_SOURCE_DIR) + "/launch/robots/p3dx.toml";
  std::string building = std::string(LUMINAV_SOURCE_DIR) + "/launch/buildings/laboratory/building.toml";
  std::int64_t runs = 20;
  std::int64_t seed = 1;
  std::int64_t kidnaps = 0;
  std::int64_t corridor = 0;
  std::int64_t clutter = 1;
  std::int64_t boxes = 4;
  double duration = 120.0;
  double off = 0.0;
  bool calibrated = false;
  bool trace = false;
  bool paper = false;
  std::string without;

  std::optional<int> parse(int argc, char** argv);
};

std::optional<int> Request::parse(int argc, char** argv) {
  CommandLine line("localizer_trials",
                   "Drives a synthetic robot many times and reports how well it finds and keeps its pose.");
  line.text("--robot", robot, "robot file").text("--building", building, "building file");
  line.integer("--runs", runs, "drives")
      .integer("--seed", seed, "first seed")
      .integer("--carries", kidnaps, "per drive");
  line.integer("--corridor", corridor, "fixtures of a symmetric corridor to drive in instead")
      .integer("--clutter", clutter, "false fixtures")
      .integer("--boxes", boxes, "things on the floor that the map does not know");
  line.number("--duration", duration, "[s] of a drive").number("--off", off, "share of the fixtures that are off");
  line.flag("--calibrated", calibrated, "constant errors a tenth").flag("--trace", trace, "print changes of state");
  line.flag("--paper", paper, "the paper's localizer");
  line.text("--without", without,
            "letters of errors to leave out: w(heels) c(amera) t(ime) f(ixtures) l (floor) o(dometry noise)");
  return line.parse(argc, argv);
}

LocalizerConfig config_of(const Request& request) {
  LocalizerConfig config = read_localizer_config(request.robot, request.building);
  config.mode = request.paper ? LocalizerMode::kPaper : config.mode;
  if (request.corridor > 0) {
    const TestBuilding test = symmetric_corridor(static_cast<int>(request.corridor), 3.0);
    config.building = test.building;
    config.walls = test.walls;
  }
  return config;
}

SyntheticOptions world_of(const Request& request, std::int64_t seed) {
  const auto has = [&](char letter) { return request.without.find(letter) == std::string::npos; };
  SyntheticOptions options;
  options.seed = static_cast<std::uint64_t>(seed);
  options.calibrated = request.calibrated;
  options.off_ratio = request.off;
  options.clutter = static_cast<int>(request.clutter);
  options.unknown_boxes = static_cast<int>(request.boxes);
  options.wheel_errors = has('w');
  options.camera_errors = has('c');
  options.time_errors = has('t');
  options.fixture_errors = has('f');
  options.floor_errors = has('l');
  options.odometry_noise = has('o');
  return options;
}

TrialPlan plan_of(const Request& request) {
  TrialPlan plan;
  plan.duration = request.duration;
  plan.trace = request.trace;
  plan.whole_only = request.paper;
  for (std::int64_t c = 1; c <= request.kidnaps; ++c) {
    plan.kidnaps.push_back(request.duration * static_cast<double>(c) / static_cast<double>(request.kidnaps + 1));
  }
  return plan;
}

int run(int argc, char** argv) {
  Request request;
  if (const auto status = request.parse(argc, argv)) {
    return *status;
  }
  LocalizerConfig config = config_of(request);
  const TrialPlan plan = plan_of(request);
  TrialSummary summary(static_cast<int>(request.kidnaps), request.duration);
  int status = 0;
  for (std::int64_t seed = request.seed; seed < request.seed + request.runs; ++seed) {
    SyntheticWorld world(config.building, config.walls, config.robot, world_of(request, seed));
    config.seed = static_cast<std::uint64_t>(seed);
    const std::unique_ptr<Localizer> localizer = make_localizer(config);
    const TrialResult result = run_trial(world, *localizer, plan);
    summary.add(result);
    if (!summary.is_flawless(result)) {
      status = 1;
      std::printf("seed %ld: localized %d correct %d after %.1f m, confident wrong %.1f s, recovered %d of %ld\n",
                  static_cast<long>(seed), result.localized, result.correct_first, result.localized_after,
                  result.confident_wrong, result.recovered, static_cast<long>(request.kidnaps));
    }
  }
  summary.print(request.paper ? "particle filter" : "hypotheses");
  return status;
}

}  // namespace
}  // namespace luminav::testing

int main(int argc, char** argv) {
  return luminav::run_guarded("localizer_trials", [&] { return luminav::testing::run(argc, argv); });
}
