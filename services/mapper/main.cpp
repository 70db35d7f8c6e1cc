#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/mapper/mapper_config.hpp"
#include "services/mapper/mapper_node.hpp"

int main(int argc, char** argv) {
  return luminav::run_guarded("mapper", [&] {
    std::string robot_file, building_file, url, state;
    luminav::CommandLine options("mapper", "Draws what the sonars see beside the building's map.");
    options.robot_file(robot_file).building_file(building_file).lcm_url(url).state_folder(state);
    if (const auto status = options.parse(argc, argv)) {
      return *status;
    }
    luminav::MapperConfig config = luminav::read_mapper_config(robot_file, building_file);
    config.state_folder = std::filesystem::path(state) / config.robot.name;
    const luminav::NetworkAccess access = luminav::read_network_access(robot_file);
    const luminav::LcmNetwork network = access.on(url);
    const auto lcm = luminav::open_lcm(network);
    luminav::MapperNode node(*lcm, config, access.key);
    luminav::receive_only(*lcm, network, node.channels());
    luminav::EventLoop loop(*lcm, "mapper", config.robot.name, network);
    loop.belong_to(robot_file);
    loop.follow_building(building_file);
    loop.report_health([&] { return node.health(); });
    return loop.run();
  });
}
