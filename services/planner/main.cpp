#include <fstream>

#include "services/common/configuration/building_file.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/planner/planner_config.hpp"
#include "services/planner/planner_node.hpp"

int main(int argc, char** argv) {
  return luminav::run_guarded("planner", [&] {
    std::string robot_file, building_file, url, state;
    luminav::CommandLine options("planner", "Plans the way to a goal and says how it is going.");
    bool maps = false;
    options.robot_file(robot_file).building_file(building_file).lcm_url(url).state_folder(state);
    options.flag(
        "--mapping", maps,
        "while the building has no map, as it is being drawn: what nobody has seen counts as free, doors look narrow");
    if (const auto status = options.parse(argc, argv)) {
      return *status;
    }
    luminav::PlannerConfig config = luminav::read_planner_config(robot_file, building_file);
    if (maps && luminav::read_building(building_file).map_file.empty()) {
      config.plan_on_a_new_map();
    }
    config.state_folder = std::filesystem::path(state) / config.robot.name;
    config.local_clock = luminav::local_time;
    std::ifstream("/proc/sys/kernel/random/boot_id") >> config.boot;
    const luminav::NetworkAccess access = luminav::read_network_access(robot_file);
    const luminav::LcmNetwork network = access.on(url);
    const auto lcm = luminav::open_lcm(network);
    luminav::PlannerNode node(*lcm, config, access.key);
    luminav::receive_only(*lcm, network, node.channels());
    luminav::EventLoop loop(*lcm, "planner", config.robot.name, network);
    loop.belong_to(robot_file);
    loop.follow_building(building_file, [&](const luminav::Building& building) {
      node.set_building(building);
      luminav::remember_files(robot_file, building_file);
    });
    loop.report_health([&] { return node.health(); });
    const int status = loop.run();
    if (status == 0) {  // somebody wanted an end
      node.end();
    }
    return status;
  });
}
