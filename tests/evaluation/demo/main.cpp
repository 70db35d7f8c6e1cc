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
#include "services/common/process/interrupts.hpp"
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
  bool view = false;
  std::int64_t id = 0;

  [[nodiscard]] int page_port() const { return 8080 + 2 * static_cast<int>(id); }
};

/// A second demo beside the first: networks ten ports farther on, a page two.
void move_apart(DemoOptions& options) {
  if (options.id < 0 || options.id > 99) {
    throw ConfigurationError(fmt::format("--id = {}, must be between 0 and 99", options.id));
  }
  if (options.id > 0) {
    unsetenv("LUMINAV_PROCMAN_URL");
    options.lcm_url = fmt::format("udpm://239.255.76.67:{}?ttl=0", 7667 + 10 * options.id);
  }
}

bool is_installed() {
  const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  return std::filesystem::exists(programs / "launch");
}

/// How a person calls a script: from here, or installed.
std::string command(const std::string& name) {
  return (is_installed() ? "luminav-" : "scripts/") + name;
}

void say_what_to_try(const DemoOptions& options, const Building& building) {
  const bool is_usual = options.scenario == shipped_file("scenarios/laboratory.toml");
  const std::string launch =
      fmt::format("{}{} {}", is_usual ? "" : fmt::format("LUMINAV_SCENARIO={} ", options.scenario), command("launch"),
                  is_installed() ? shipped_file("demo.pmd") : "launch/demo.pmd");
  const std::string go =
      fmt::format("{} {}", command("goto"), building.places.empty() ? "X Y" : building.places.front().name);
  const std::size_t width = std::max(launch.size(), go.size());
  fmt::print("\nWhat to try next:\n");
  for (const auto& [line, does] :
       {std::pair{launch, std::string("the same robot, until Ctrl-C; in another terminal then:")},
        {command("view"), "watch and drive it at http://localhost:8080"},
        {go, fmt::format("send it somewhere; {} ends that, {} stops it", command("cancel"), command("stop"))}}) {
    fmt::print("  {:<{}}  # {}\n", line, width, does);
  }
}

/// After the goals the page goes on: the robot is the visitor's until Ctrl-C.
void stay(lcm::LCM& lcm, DemoSystem& system, const DemoOptions& options) {
  fmt::print("\nThe robot is yours at http://localhost:{}/ until Ctrl-C.\n", options.page_port());
  std::fflush(stdout);
  while (!take_interrupt() && system.is_whole()) {
    system.pump(lcm);
  }
}

/// Asks the desktop, where there is one, for a browser.
void open_browser(int port) {
  if (isatty(STDOUT_FILENO) != 0 && (getenv("DISPLAY") != nullptr || getenv("WAYLAND_DISPLAY") != nullptr)) {
    const std::string line = fmt::format("xdg-open http://localhost:{}/ >/dev/null 2>&1 &", port);
    [[maybe_unused]] const int status = std::system(line.c_str());
  }
}

/// Drives one run to its end, showing what happens. Nothing = interrupted, or the system's failure() says why.
std::optional<RunReport> drive(lcm::LCM& lcm, DemoSystem& system, const Scenario& scenario, const WorldTruth& world,
                               const DemoOptions& options) {
  RunJudge judge(lcm, scenario, world);
  Mission mission(lcm, scenario);
  DemoDisplay display(lcm, judge, mission, scenario, options.headless);
  if (!system.start(lcm)) {
    return std::nullopt;
  }
  if (options.view) {
    system.start_viewer(scenario, options.lcm_url, options.page_port());
    open_browser(options.page_port());
  }
  std::set<std::size_t> killed;
  const std::int64_t started = launcher::Instant::read().steady;
  const auto too_long = [&] {  // the simulator itself may have died
    return static_cast<double>(launcher::Instant::read().steady - started) * 1e-6 > scenario.duration + 30.0;
  };
  while (!mission.is_finished() && judge.elapsed() < scenario.duration && !too_long()) {
    if (take_interrupt() || !system.is_whole()) {
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

/// Nothing where the demo may go on, else the exit status.
std::optional<int> read_options(int argc, char** argv, DemoOptions& options) {
  CommandLine line(
      "demo",
      "A simulated P3-DX finds out where it is by the ceiling's lights and drives to the scenario's goals, "
      "every process of the system running for itself.");
  line.flag("--headless", options.headless, "plain lines instead of a live display")
      .text("--scenario", options.scenario, "scenario file")
      .integer("--seed", options.seed, "instead of the scenario's own")
      .number("--duration", options.duration, "[s] time limit instead of the scenario's own")
      .text("--mode", options.mode, "paper | modern, for all nodes that have both; default as the robot's file says")
      .output_file("--json,--report", options.report, "write the report there (JSON)")
      .output_file("--png,--picture", options.picture, "write a picture of the run there (PNG)")
      .text("--log", options.log, "record all data channels there (lcm-logger)")
      .flag("--view", options.view, "show the page, http://localhost:8080/, and go on with it when the goals are done")
      .integer("--id", options.id, "of a further demo beside others, 1 to 99: on ports of its own")
      .lcm_url(options.lcm_url);
  return line.parse(argc, argv);
}

void check(const DemoOptions& options) {
  if (!options.mode.empty() && options.mode != "paper" && options.mode != "modern") {
    throw ConfigurationError(fmt::format("--mode {}: must be paper or modern", options.mode));
  }
  if (options.duration < 0.0) {
    throw ConfigurationError(fmt::format("--duration = {}, must be above 0 s", options.duration));
  }
  check_writable("--report", options.report);
  check_writable("--picture", options.picture);
  check_writable("--log", options.log);
  if (options.log == "-") {
    throw ConfigurationError("--log -: a log is a file, with what is needed to replay it beside");
  }
  if (!options.log.empty() && std::filesystem::exists(options.log)) {
    throw std::runtime_error(fmt::format("{}: exists already, logs are never overwritten", options.log));
  }
}

Scenario scenario_of(const DemoOptions& options) {
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
  return scenario;
}

void say_where_it_is_seen(const DemoOptions& options) {
  if (options.view) {
    fmt::print("demo: the page is at http://localhost:{}/\n", options.page_port());
  } else if (options.id > 0) {
    fmt::print("demo: other terminals say first: export LUMINAV_LCM_URL='{}'; the page is {} --port {}\n",
               options.lcm_url, command("view"), options.page_port());
  } else {
    fmt::print("demo: to watch it, say {} in another terminal\n", command("view"));
  }
  std::fflush(stdout);
}

int demo(int argc, char** argv) {
  DemoOptions options;
  if (const auto status = read_options(argc, argv, options)) {
    return *status;
  }
  move_apart(options);
  check(options);
  const Scenario scenario = scenario_of(options);
  const Building building = read_building(scenario.building_file);
  const WorldTruth world = draw_world(scenario, building, read_robot(scenario.robot_file));
  const auto lcm = open_lcm(options.lcm_url);
  catch_interrupts();
  fmt::print("demo: {} with seed {}, world {}, on {}\n", scenario.name, scenario.seed, world.hash, options.lcm_url);
  say_where_it_is_seen(options);
  DemoSystem system(scenario, options.mode, options.lcm_url, options.log);
  const std::optional<RunReport> report = drive(*lcm, system, scenario, world, options);
  const bool was_whole = system.is_whole();
  if (report) {
    fmt::print("{}", to_text(*report));
  }
  if (report && was_whole && options.view) {
    stay(*lcm, system, options);
  }
  system.stop();
  if (!report) {
    fmt::print("demo: {}\n", system.failure().empty() ? "interrupted, everything stopped" : system.failure());
    return system.failure().empty() ? 130 : 1;
  }
  if (!options.view) {
    say_what_to_try(options, building);
  }
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
