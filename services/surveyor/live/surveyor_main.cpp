#include <filesystem>
#include <string>

#include "services/common/configuration/configuration_error.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/surveyor/live/surveyor_node.hpp"

int main(int argc, char** argv) {
  return luminav::run_guarded("surveyor", [&] {
    std::string robot_file, kinds_file, building_file, folder, url, state;
    luminav::CommandLine line("surveyor", "Draws the building's map while somebody drives the robot through it.");
    line.robot_file(robot_file).lcm_url(url).state_folder(state);
    line.text("--kinds", kinds_file,
              "TOML file with ceiling_height and a [[kind]] for each kind of fixture; none = those of --building")
        .text("--building", building_file, "building file or folder that the survey goes on with; none = a new one")
        .text("--out", folder, "folder of the survey: new, or one that is to be gone on with", true);
    std::string driver = "person";
    line.text("--driver", driver,
              "person | robot: who drives at first; the robot until nothing that it can reach is left");
    if (const auto status = line.parse(argc, argv)) {
      return *status;
    }
    if (driver != "person" && driver != "robot") {
      throw luminav::ConfigurationError("--driver = " + driver + ": must be person or robot");
    }
    for (std::string* file : {&kinds_file, &building_file}) {
      *file = *file == "none" ? "" : *file;  // a configuration of processes has the same words each time
    }
    luminav::SurveyorConfig config = luminav::read_surveyor_config(robot_file, kinds_file, folder, building_file);
    config.state = std::filesystem::path(state) / config.model.robot.name;
    const luminav::NetworkAccess access = luminav::read_network_access(robot_file);
    const luminav::LcmNetwork network = access.on(url);
    const auto lcm = luminav::open_lcm(network);
    luminav::SurveyorNode node(*lcm, config, access.key);
    if (driver == "robot") {
      node.explore_at_once();
    }
    luminav::receive_only(*lcm, network, node.channels());
    luminav::EventLoop loop(*lcm, "surveyor", config.model.robot.name, network);
    loop.belong_to(robot_file);
    loop.report_health([&] { return node.health(); });
    constexpr std::int64_t kLookPeriod = 500'000;  // [us] a survey ends also where the robot is switched off
    loop.every(
        kLookPeriod, [&] { node.take_results(); }, kLookPeriod / 2);
    return loop.run();
  });
}
