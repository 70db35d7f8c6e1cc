#include <string>
#include <utility>

#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/localizer/localizer_config.hpp"
#include "services/localizer/localizer_node.hpp"

int main(int argc, char** argv) {
  return luminav::run_guarded("localizer", [&] {
    std::string robot;
    std::string building;
    std::string url;
    std::string state;
    luminav::CommandLine line("localizer", "Finds and follows the robot's pose by the ceiling's fixtures.");
    line.robot_file(robot).building_file(building).lcm_url(url).state_folder(state);
    if (const auto status = line.parse(argc, argv)) {
      return *status;
    }
    luminav::LocalizerConfig config = luminav::read_localizer_config(robot, building);
    config.walls = luminav::resample(config.walls, luminav::WallField::kResolution);  // all that is needed of them
    config.state_dir = state + "/" + config.robot.name;
    const std::string robot_name = config.robot.name;
    const luminav::NetworkAccess access = luminav::read_network_access(robot);
    const luminav::LcmNetwork network = access.on(url);
    const auto lcm = luminav::open_lcm(network);
    luminav::LocalizerNode node(*lcm, std::move(config), access.key);
    luminav::receive_only(*lcm, network, node.channels());
    luminav::EventLoop loop(*lcm, "localizer", robot_name, network);
    loop.belong_to(robot);
    loop.follow_building(building);
    loop.report_health([&] { return node.health(); });
    return loop.run();
  });
}
