#include "drivers/p3dx/p3dx_config.hpp"

#include "drivers/p3dx/arcos/arcos_commands.hpp"

namespace luminav {

P3dxConfig read_p3dx_config(const std::filesystem::path& robot_file) {
  const TomlTable root = TomlTable::load(robot_file);
  P3dxConfig config;
  config.robot = read_robot(root);
  config.angular_deceleration = config.robot.limits.angular_acceleration;
  const TomlTable table = root.table("p3dx");
  config.device = table.text("device", config.device);
  config.baud = table.count("baud", config.baud, {9600, 115200});
  config.fast_baud = table.count("fast_baud", config.fast_baud, {0, 115200});
  config.enable_motors_at_start = table.choice("enable_motors", "at_start", {"at_start", "on_request"}) == "at_start";
  config.assume_p3dx_sh = table.boolean("assume_p3dx_sh", config.assume_p3dx_sh);
  config.command_timeout = table.number("command_timeout", config.command_timeout, {0.1, 1.0});
  config.angular_deceleration = table.number("angular_deceleration", config.angular_deceleration, {0.05, 20.0});
  config.supervised = table.number("supervised", config.supervised, {0.0, 600.0});
  config.distance_factor = table.number("distance_factor", config.distance_factor, {0.0, 10.0});
  table.reject_unknown();
  for (const char* key : {"baud", "fast_baud"}) {
    const int rate = key == std::string_view("baud") ? config.baud : config.fast_baud;
    const bool stays = rate == 0 && key == std::string_view("fast_baud");
    if (!stays && code_of_baud(rate) < 0) {
      table.fail(key, "must be 9600, 19200, 38400, 57600 or 115200");
    }
  }
  check_base_config(table, config, config.baud);
  return config;
}

}  // namespace luminav
