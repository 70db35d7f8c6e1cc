#include <fmt/format.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/configuration/shipped_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/launcher/network.hpp"
#include "services/launcher/sheriff/session.hpp"
#include "services/launcher/sheriff/sheriff.hpp"
#include "tests/evaluation/demo/demo_display.hpp"
#include "tests/evaluation/demo/demo_system.hpp"
#include "tests/evaluation/judge/run_judge.hpp"
#include "tests/evaluation/judge/run_picture.hpp"
#include "tests/evaluation/report/output_file.hpp"
#include "tests/evaluation/runs/mission.hpp"
#include "tests/evaluation/runs/scenario_run.hpp"

namespace luminav {
namespace {

struct DemoOptions {
  std::string scenario = shipped_file("scenarios/laboratory.toml");
  std::int64_t seed = -1;
  double duration = 0.0;
  std::string report;
  std::string picture;
  std::string log;
  bool headless = false;
  std::string mode;
  std::string lcm_url;
};

/// Drives one run to its end, showing what happens. Nothing = interrupted, or the system's failure() says why.
std::optional<RunReport> drive(lcm::LCM& lcm, DemoSystem& system, const Scenario& scenario, const WorldTruth& world,
                               const DemoOptions& options) {
  RunJudge judge(lcm, scenario, world);
  Mission mission(lcm, scenario);
  DemoDisplay display(lcm, judge, mission, scenario, options.headless);
  if (!system.start(lcm)) {
    return std::nullopt;
  }
  std::set<std::size_t> killed;
  const std::int64_t started = launcher::Instant::read().steady;
  const auto too_long = [&] {  // the simulator itself may have died
    return static_cast<double>(launcher::Instant::read().steady - started) * 1e-6 > scenario.duration + 30.0;
  };
  while (!mission.is_finished() && judge.elapsed() < scenario.duration && !too_long()) {
    if (launcher::take_interrupt() || !system.is_whole()) {
      return std::nullopt;
    }
    system.pump(lcm);
    for (std::size_t i = 0; i < scenario.events.size(); ++i) {
      const ScenarioEvent& event = scenario.events[i];
      if (event.kind == EventKind::kKill && judge.elapsed() >= event.at && killed.insert(i).second) {
        system.kill_process(event.process);
      }
    }
    display.update(system.sheriff().states());
  }
  display.finish();
  RunReport report = conclude(judge, mission, world);
  report.wall_s = static_cast<double>(launcher::Instant::read().steady - started) * 1e-6;
  for (ProcessResult& process : report.processes) {
    for (const launcher::CommandState& state : system.sheriff().states()) {
      if (state.name == process.name) {
        process.restarts = state.restarts;
      }
    }
  }
  if (!options.picture.empty()) {
    const std::optional<OccupancyGrid> grid = judge.grid();
    draw_run(options.picture, world, read_building(scenario.building_file), judge.trail(), report.goals,
             grid ? &*grid : nullptr);
  }
  return report;
}

int demo(int argc, char** argv) {
  DemoOptions options;
  CommandLine line(
      "demo",
      "A simulated P3-DX finds out where it is by the ceiling's lights and drives to the scenario's goals, "
      "every process of the system running for itself.");
  line.flag("--headless", options.headless, "plain lines instead of a live display")
      .text("--scenario", options.scenario, "scenario file")
      .integer("--seed", options.seed, "instead of the scenario's own")
      .number("--duration", options.duration, "[s] time limit instead of the scenario's own")
      .text("--mode", options.mode, "paper | modern, for all nodes that have both; default as the robot's file says")
      .output_file("--report", options.report, "write the report there (JSON)")
      .output_file("--picture", options.picture, "write a picture of the run there (PNG)")
      .text("--log", options.log, "record all data channels there (lcm-logger)")
      .lcm_url(options.lcm_url);
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  if (!options.mode.empty() && options.mode != "paper" && options.mode != "modern") {
    throw ConfigurationError(fmt::format("--mode {}: must be paper or modern", options.mode));
  }
  Scenario scenario = read_scenario(options.scenario);
  if (options.seed >= 0) {
    scenario.seed = static_cast<std::uint64_t>(options.seed);
  }
  if (options.duration > 0.0) {
    scenario.duration = options.duration;
  }
  for (const ScenarioEvent& event : scenario.events) {
    if (event.kind == EventKind::kClock) {
      fmt::print(stderr, "demo: this machine's clock stays as it is, at {} s too: two_hosts steps clocks\n", event.at);
    }
  }
  check_writable("--report", options.report);
  check_writable("--picture", options.picture);
  check_writable("--log", options.log);
  const WorldTruth world = draw_world(scenario, read_building(scenario.building_file), read_robot(scenario.robot_file));
  if (options.log == "-") {
    throw ConfigurationError("--log -: a log is a file, with what is needed to replay it beside");
  }
  if (!options.log.empty() && std::filesystem::exists(options.log)) {
    throw std::runtime_error(fmt::format("{}: exists already, logs are never overwritten", options.log));
  }
  const auto lcm = open_lcm(options.lcm_url);
  launcher::catch_interrupts();
  fmt::print("demo: {} with seed {}, world {}, on {}\n", scenario.name, scenario.seed, world.hash, options.lcm_url);
  std::fflush(stdout);
  DemoSystem system(scenario, options.mode, options.lcm_url, options.log);
  const std::optional<RunReport> report = drive(*lcm, system, scenario, world, options);
  const bool was_whole = system.is_whole();
  system.stop();
  if (!report) {
    fmt::print("demo: {}\n", system.failure().empty() ? "interrupted, everything stopped" : system.failure());
    return system.failure().empty() ? 130 : 1;
  }
  fmt::print("{}", to_text(*report));
  if (!options.report.empty()) {
    write_whole_file(options.report, to_json(*report));
  }
  if (!was_whole) {
    fmt::print("demo: {}\n", system.failure());
  }
  return report->passed && was_whole ? 0 : 1;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("demo", [&] { return luminav::demo(argc, argv); });
}
