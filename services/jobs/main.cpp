#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <optional>

#include "services/common/calendar/local_time.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/clock.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/jobs/jobs_config.hpp"
#include "services/jobs/jobs_file_watch.hpp"
#include "services/jobs/jobs_node.hpp"
#include "services/jobs/speech/speaker.hpp"

namespace {

/// A jobs file that cannot be read leaves home and tours as they were.
luminav::Health health_of(const luminav::JobsNode& node, const luminav::JobsFileWatch& jobs) {
  luminav::Health health = node.health();
  if (!health.degraded && !jobs.objection().empty()) {
    health.degraded = true;
    health.reason = jobs.objection();
  }
  return health;
}

void speak(luminav::JobsNode& node, luminav::Speaker& speaker) {
  if (const std::string sentence = node.take_sentence(); !sentence.empty()) {
    speaker.say(sentence);
  }
  speaker.tick();
  if (const std::string complaint = speaker.take_complaint(); !complaint.empty()) {
    fmt::print(stderr, "jobs: {}\n", complaint);
  }
}

}  // namespace

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
    luminav::Building known;
    luminav::JobsFileWatch jobs(jobs_file.empty() ? luminav::jobs_file_of(building_file)
                                                  : std::filesystem::path(jobs_file));
    loop.follow_building(building_file, [&](const luminav::Building& building) {
      known = building;
      node.set_places(building.places);
      luminav::remember_files(robot_file, building_file);
    });
    loop.report_health([&] { return health_of(node, jobs); });
    loop.every(
        1'000'000,
        [&] {
          if (const auto changed = jobs.look(known)) {
            node.set_jobs(*changed);
          }
          node.tell_time(luminav::local_time(luminav::read_clock(CLOCK_REALTIME)));
        },
        500'000);
    bool hears_pictures = false;
    loop.every(
        200'000,
        [&] {
          if (node.wants_pictures() != hears_pictures) {  // the kernel keeps them away else
            hears_pictures = !hears_pictures;
            luminav::receive_only(*lcm, network, node.channels());
          }
        },
        100'000);
    std::optional<luminav::Speaker> speaker;
    if (config.speech != "off") {
      speaker.emplace(luminav::espeak_command(config.speech));
      loop.every(
          100'000, [&] { speak(node, *speaker); }, 50'000);
    }
    const int status = loop.run();
    if (status == 0) {  // somebody wanted an end
      node.end();
    }
    return status;
  });
}
