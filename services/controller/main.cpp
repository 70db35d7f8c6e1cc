#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/controller/controller_node.hpp"

int main(int argc, char** argv) {
  return luminav::run_guarded("controller", [&] {
    std::string robot_file;
    std::string building_file;
    std::string url;
    std::string state;
    luminav::CommandLine command_line("controller", "Drives the robot along a path and never into anything.");
    command_line.robot_file(robot_file)
        .text("--building", building_file, "building file (TOML): a lost robot searches by what it predicts");
    command_line.lcm_url(url).state_folder(state);
    if (const auto status = command_line.parse(argc, argv)) {
      return *status;
    }
    luminav::ControllerConfig config = luminav::read_controller_config(robot_file, building_file);
    config.local_clock = luminav::local_time;
    const luminav::NetworkAccess access = luminav::read_network_access(robot_file);
    const luminav::LcmNetwork network = access.on(url);
    const auto lcm = luminav::open_lcm(network);
    luminav::ControllerNode node(*lcm, config, access.key);
    luminav::receive_only(*lcm, network, node.channels());
    luminav::EventLoop loop(*lcm, "controller", config.robot.name, network);
    loop.belong_to(robot_file);
    loop.follow_building(building_file, [&](const luminav::Building& building) { node.set_zones(building.zones); });
    loop.report_health([&node] { return node.health(); });
    return loop.run();
  });
}
