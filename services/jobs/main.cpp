#include <fstream>

#include "services/common/calendar/local_time.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/jobs/jobs_config.hpp"
#include "services/jobs/jobs_node.hpp"

int main(int argc, char** argv) {
  return luminav::run_guarded("jobs", [&] {
    std::string robot_file, building_file, jobs_file, url, state;
    luminav::CommandLine options("jobs", "Keeps the queue of jobs and drives the robot through it.");
    options.robot_file(robot_file).building_file(building_file).lcm_url(url).state_folder(state);
    options.text("--jobs", jobs_file, "home and stored tours (TOML); default: jobs.toml beside the building's file");
    if (const auto status = options.parse(argc, argv)) {
      return *status;
    }
    luminav::JobsConfig config = luminav::read_jobs_config(robot_file, building_file, jobs_file);
    config.state_folder = std::filesystem::path(state) / config.robot.name;
    std::ifstream("/proc/sys/kernel/random/boot_id") >> config.boot;
    const luminav::NetworkAccess access = luminav::read_network_access(robot_file);
    const luminav::LcmNetwork network = access.on(url);
    const auto lcm = luminav::open_lcm(network);
    luminav::JobsNode node(*lcm, config, access.key);
    luminav::receive_only(*lcm, network, node.channels());
    luminav::EventLoop loop(*lcm, "jobs", config.robot.name, network);
    loop.belong_to(robot_file);
    loop.follow_building(building_file, [&](const luminav::Building& building) {
      node.set_places(building.places);
      luminav::remember_files(robot_file, building_file);
    });
    loop.report_health([&] { return node.health(); });
    loop.every(
        1'000'000, [&] { node.tell_time(luminav::local_time(luminav::read_clock(CLOCK_REALTIME))); }, 500'000);
    const int status = loop.run();
    if (status == 0) {  // somebody wanted an end
      node.end();
    }
    return status;
  });
}
