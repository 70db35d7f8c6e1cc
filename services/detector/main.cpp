#include <opencv2/core.hpp>

#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/detector/detector_config.hpp"
#include "services/detector/detector_node.hpp"

int main(int argc, char** argv) {
  return luminav::run_guarded("detector", [&] {
    std::string robot_file;
    std::string building_file;
    std::string lcm_url;
    luminav::CommandLine command_line("detector", "Finds the ceiling's light fixtures in the camera's images.");
    command_line.robot_file(robot_file).building_file(building_file).lcm_url(lcm_url);
    if (const auto status = command_line.parse(argc, argv)) {
      return *status;
    }
    const luminav::DetectorConfig config = luminav::read_detector_config(robot_file, building_file);
    const luminav::LcmNetwork network = luminav::read_network_access(robot_file).on(lcm_url);
    const auto lcm = luminav::open_lcm(network);
    cv::setNumThreads(1);  // pictures are small
    luminav::DetectorNode node(*lcm, config);
    luminav::receive_only(*lcm, network, node.channels());
    luminav::EventLoop loop(*lcm, "detector", config.robot, network);
    loop.belong_to(robot_file);
    loop.follow_building(building_file);
    loop.report_health([&node] { return node.health(); });
    return loop.run();
  });
}
