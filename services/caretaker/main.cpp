#include <string>

#include "services/caretaker/caretaker_node.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"

int main(int argc, char** argv) {
  return luminav::run_guarded("caretaker", [&] {
    std::string robot_file, building_file, url, state;
    luminav::CommandLine line("caretaker", "Keeps a ledger of how the ceiling's fixtures looked, visit after visit.");
    line.robot_file(robot_file).building_file(building_file).lcm_url(url).state_folder(state);
    if (const auto status = line.parse(argc, argv)) {
      return *status;
    }
    const luminav::RobotDescription robot = luminav::read_robot(robot_file);
    const luminav::Building building = luminav::read_building(building_file);
    const luminav::LcmNetwork network = luminav::read_network_access(robot_file).on(url);
    const auto lcm = luminav::open_lcm(network);
    luminav::CaretakerNode node(*lcm, robot, building, luminav::ledger_file(state, robot.name));
    luminav::receive_only(*lcm, network, node.channels());
    luminav::EventLoop loop(*lcm, "caretaker", robot.name, network);
    loop.belong_to(robot_file);
    loop.follow_building(building_file);
    loop.report_health([&] { return node.health(); });
    constexpr std::int64_t kSavePeriod = 10'000'000;  // [us] of visits that a crash may lose
    loop.every(
        kSavePeriod, [&] { node.save(); }, kSavePeriod / 2);
    const int status = loop.run();
    node.finish();
    return status;
  });
}
