#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "drivers/simulator/arcos/arcos_controller.hpp"
#include "drivers/simulator/board_server.hpp"
#include "drivers/simulator/create2/create2_board.hpp"
#include "drivers/simulator/simulator_node.hpp"
#include "drivers/simulator/world/scenario.hpp"
#include "drivers/simulator/world/world_truth.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"

namespace {

struct Options {
  std::string scenario;
  std::string lcm_url;
  std::string pty_link;
  std::string name = "luminav";
  std::string subclass = "p3dx-sh";
  std::string quirks = "none";
  std::int64_t port = 8101;
  std::int64_t seed = -1;
  bool pty = false;
  bool all_addresses = false;
};

/// The controller of the base that the robot's file names.
std::unique_ptr<luminav::BaseBoard> make_board(const std::string& base, double wheel_base, const Options& options) {
  if (base == "create2") {
    return std::make_unique<luminav::Create2Board>(wheel_base);
  }
  luminav::ArcosConfig config;
  config.wheel_base = wheel_base;
  config.mobilesim = options.quirks == "mobilesim";
  config.flash.name = options.name;
  config.flash.subclass = options.subclass;
  return std::make_unique<luminav::ArcosController>(config);
}

int run(const Options& options) {
  using namespace luminav;
  Scenario scenario = read_scenario(options.scenario);
  if (options.seed >= 0) {
    scenario.seed = static_cast<std::uint64_t>(options.seed);
  }
  if (options.quirks != "none" && options.quirks != "mobilesim") {
    throw ConfigurationError(fmt::format("--quirks {}: must be none or mobilesim", options.quirks));
  }
  if (options.port < 0 || options.port > 65535) {
    throw ConfigurationError(fmt::format("--port {}: must be between 0 and 65535", options.port));
  }
  const RobotDescription robot = read_robot(scenario.robot_file);
  const WorldTruth truth = draw_world(scenario, read_building(scenario.true_building_file), robot);

  const std::unique_ptr<BaseBoard> board = make_board(scenario.base, robot.wheel_base, options);
  const auto server = options.pty || !options.pty_link.empty()
                          ? BoardServer::on_pty(*board, options.pty_link)
                          : BoardServer::on_tcp(*board, static_cast<int>(options.port), options.all_addresses);
  const auto lcm = open_lcm(options.lcm_url);
  SimulatorNode node(*lcm, scenario.seed, truth, *board);
  receive_only(*lcm, options.lcm_url, {});  // it only speaks
  fmt::print("simulator: {} seed {}, robot at {}\n{}world {}\n", scenario.name, scenario.seed, server->address(),
             truth.table, truth.hash);
  std::fflush(stdout);

  EventLoop loop(*lcm, "simulator", robot.name, options.lcm_url);
  const HostClock clock;
  const auto exchange = [&] {
    server->set_unplugged(node.serial_unplugged());
    server->poll();
  };
  constexpr std::size_t kDescriptors = 2;  // the listener and its client
  for (std::size_t i = 0; i < kDescriptors; ++i) {
    loop.watch(
        [&server, i] {
          const auto descriptors = server->descriptors();
          return i < descriptors.size() ? descriptors[i] : -1;
        },
        exchange);
  }
  loop.every(SimulatorNode::kTick, [&] {
    server->poll();
    node.advance_to(clock.utime());
    exchange();
  });
  return loop.run();
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  luminav::CommandLine line("simulator",
                            "A simulated P3-DX or Create 2 in a building; speaks the robot's serial protocol.");
  line.text("--scenario", options.scenario, "scenario file (TOML)", true)
      .integer("--port", options.port, "TCP port of the robot; 0 = any free one")
      .flag("--all-addresses", options.all_addresses, "listen on all addresses, not only on 127.0.0.1")
      .flag("--pty", options.pty, "a pseudo terminal instead of TCP")
      .text("--pty-link", options.pty_link, "a pseudo terminal, and a symbolic link to it under this name")
      .integer("--seed", options.seed, "instead of the scenario's")
      .text("--name", options.name, "name that the robot says it has")
      .text("--subclass", options.subclass, "kind that the robot says it is")
      .text("--quirks", options.quirks, "none | mobilesim: habits of that simulator's robot")
      .lcm_url(options.lcm_url);
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  return luminav::run_guarded("simulator", [&] { return run(options); });
}
