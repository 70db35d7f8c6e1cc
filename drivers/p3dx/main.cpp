#include "drivers/base/base_process.hpp"
#include "drivers/p3dx/p3dx_node.hpp"
#include "drivers/p3dx/safety/arcos_guard.hpp"
#include "services/common/process/command_line.hpp"

using namespace luminav;

int main(int argc, char** argv) {
  return run_guarded("p3dx", [&] {
    BaseOptions options;
    if (const auto status = options.parse(
            "p3dx", "Drives a Pioneer P3-DX: ODOMETRY, SONAR and ROBOT_STATUS out, VELOCITY_COMMAND in", argc, argv)) {
      return *status;
    }
    P3dxConfig config = read_p3dx_config(options.robot_file);
    const GuardianParams guarding = options.apply_to(config);
    const OpenStream opener = open_by_configuration(config.device, config.baud);
    return run_base("p3dx", options, config.robot.name, guarded_arcos(), guarding,
                    [&](lcm::LCM& lcm, const Clock& clock, std::optional<CommandKey> key) {
                      return std::make_unique<P3dxNode>(lcm, config, clock, opener, key);
                    });
  });
}
