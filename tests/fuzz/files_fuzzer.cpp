// Everything that is read from a file: what a user writes, what the processes keep, what was recorded. A file that is
// wrong gets one sentence as an exception, or counts as none; nothing else may happen.
#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>

#include "drivers/base/safety/stop_latch.hpp"
#include "drivers/simulator/world/scenario.hpp"
#include "services/common/building/map_file.hpp"
#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/robot_file.hpp"
#include "services/common/log/log_file.hpp"
#include "services/common/network/network_access.hpp"
#include "services/launcher/pmd_file.hpp"
#include "services/localizer/pose_memory.hpp"
#include "services/mapper/evidence_file.hpp"
#include "services/planner/goals/goal_store.hpp"
#include "services/viewer/request_text.hpp"
#include "tests/replay/log_reading/message_schema.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace luminav;

namespace {

const TemporaryFolder& folder() {
  static const TemporaryFolder kFolder;
  return kFolder;
}

std::filesystem::path write(const char* name, const std::string& text) {
  return folder().write(name, text);
}

void read_log(const std::string& text) {
  LogReader reader(write("x.lcm", text).string());
  for (LogEvent event; reader.next(event);) {
    (void)MessageSchemas::built_in().decode(event.data, 8);
  }
  (void)reader.damage();
}

void read_request(const std::string& text) {
  static const Building kBuilding;
  const std::string body = text.empty() ? text : text.substr(1);
  switch (text.empty() ? 0 : text[0] % 7) {
    case 0:
      (void)read_goal_request(body, kBuilding);
      break;
    case 1:
      (void)read_stop_request(body);
      break;
    case 2:
      (void)read_motors_request(body);
      break;
    case 3:
      (void)read_initial_pose_request(body);
      break;
    case 4:
      (void)read_map_request(body);
      break;
    case 5:
      (void)read_steering(body);
      break;
    default:
      (void)read_process_order(body);
  }
}

const std::array<std::function<void(const std::string&)>, 13> kReaders = {
    [](const std::string& text) { (void)read_robot(write("robot.toml", text)); },
    [](const std::string& text) { (void)read_building(write("building.toml", text)); },
    [](const std::string& text) { (void)read_scenario(write("scenario.toml", text)); },
    [](const std::string& text) {
      write("map.pgm", "P5\n3 2\n255\nabcdef");
      (void)resample(read_map(write("map.yaml", text)), 1.0);
    },
    [](const std::string& text) {
      write("map.pgm", text);
      (void)read_map(write("map.yaml", "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n"));
    },
    [](const std::string& text) { (void)launcher::parse_pmd(text, "x.pmd"); },
    [](const std::string& text) { (void)(write("goal.bin", text), GoalStore(folder().path()).recall()); },
    [](const std::string& text) {
      OccupancyGrid grid({0.1, {0.0, 0.0}, 64, 64});
      (void)read_evidence(write("evidence.bin", text), grid);
    },
    [](const std::string& text) { (void)(write("localizer_pose.toml", text), PoseMemory(folder().path(), {}).load()); },
    [](const std::string& text) {
      std::filesystem::create_directories(folder().path() / "p3dx");
      write("stop", text);
      (void)StopLatch(folder().path()).engaged();
    },
    read_log,
    read_request,
    [](const std::string& text) { (void)read_network_access(write("network.toml", text)); },
};

}  // namespace

/// The first byte says which kind of file.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) {
    try {
      kReaders[data[0] % kReaders.size()](std::string(reinterpret_cast<const char*>(data) + 1, size - 1));
    } catch (const std::runtime_error&) {
      // one sentence for the user
    }
  }
  return 0;
}
