#include "drivers/create2/create2_config.hpp"

namespace luminav {

Create2Config read_create2_config(const std::filesystem::path& robot_file) {
  const TomlTable root = TomlTable::load(robot_file);
  Create2Config config;
  config.robot = read_robot(root);
  const TomlTable table = root.table("create2");
  config.device = table.text("device", config.device);
  config.baud = table.count("baud", config.baud, {19200, 115200});
  config.enable_motors_at_start = table.choice("enable_motors", "at_start", {"at_start", "on_request"}) == "at_start";
  config.command_timeout = table.number("command_timeout", config.command_timeout, {0.1, 1.0});
  config.supervised = table.number("supervised", config.supervised, {0.0, 600.0});
  table.reject_unknown();
  if (config.baud != 19200 && config.baud != 115200) {
    table.fail("baud", "must be 19200 or 115200");
  }
  if (!config.robot.sonar.robot_from_sonar.empty()) {
    root.fail("sonar", "must be left out: a Create 2 has no sonars");
  }
  check_base_config(table, config, config.baud);
  return config;
}

}  // namespace luminav
