#include "services/operator/system_files.hpp"

#include <fmt/format.h>

#include <cstdlib>

#include "services/common/configuration/shipped_file.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "services/common/process/channels.hpp"
#include "services/operator/goal_target.hpp"

namespace luminav {
namespace {

std::string default_robot_file() {
  const char* launched = std::getenv("LUMINAV_ROBOT");
  return launched != nullptr && *launched != '\0' ? launched : shipped_file("robots/p3dx.toml");
}

void check(const char* what, const std::string& asked, const std::string& running, bool is_same) {
  if (!is_same) {
    throw ConfigurationError(asked == running
                                 ? fmt::format("the running system has another file of {} {}", what, running)
                                 : fmt::format("the running system has {} {}, not {}", what, running, asked));
  }
}

std::string found(const std::string& file, const char* what, const std::string& name) {
  if (file.empty()) {
    throw ConfigurationError(
        fmt::format("the running system has {} {}, whose file is not known here: give --{} FILE", what, name, what));
  }
  return file;
}

}  // namespace

SystemListener::SystemListener(lcm::LCM& lcm) : subscriber_(lcm) {
  subscriber_.on(channels::kNodeStatus, &SystemListener::on_node_status, this);
}

FilePaths choose_files(const RunningSystem& system, const FilePaths& asked) {
  if (const std::string text = system.disagreement(0); !text.empty()) {
    throw ConfigurationError("the processes do not belong together: " + text);
  }
  const std::optional<SystemFiles> running = system.files();
  FilePaths chosen = asked;
  if (!running) {
    chosen.robot = asked.robot.empty() ? default_robot_file() : asked.robot;
    chosen.building = asked.building.empty() ? default_building_file() : asked.building;
    return chosen;
  }
  const SystemFiles named = identify(asked.robot, asked.building);
  if (asked.building.empty()) {
    chosen.building =
        found(find_building(running->building_hash, {default_building_file()}), "building", running->building);
  } else {
    check("building", named.building, running->building, named.building_hash == running->building_hash);
  }
  if (asked.robot.empty()) {
    chosen.robot = found(find_robot(running->robot_hash, {default_robot_file()}), "robot", running->robot);
  } else {
    check("robot", named.robot, running->robot, named.robot_hash == running->robot_hash);
  }
  return chosen;
}

}  // namespace luminav
