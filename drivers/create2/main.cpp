#include "drivers/base/base_process.hpp"
#include "drivers/create2/create2_node.hpp"
#include "drivers/create2/safety/oi_guard.hpp"
#include "services/common/process/command_line.hpp"

using namespace luminav;

int main(int argc, char** argv) {
  return run_guarded("create2", [&] {
    BaseOptions options;
    if (const auto status = options.parse(
            "create2", "Drives an iRobot Create 2 or Roomba: ODOMETRY and ROBOT_STATUS out, VELOCITY_COMMAND in", argc,
            argv)) {
      return *status;
    }
    Create2Config config = read_create2_config(options.robot_file);
    const GuardianParams guarding = options.apply_to(config);
    const OpenStream opener = open_by_configuration(config.device, config.baud);
    return run_base("create2", options, config.robot.name, guarded_create2(), guarding,
                    [&](lcm::LCM& lcm, const Clock& clock, std::optional<CommandKey> key) {
                      return std::make_unique<Create2Node>(lcm, config, clock, opener, key);
                    });
  });
}
