#include <string>

#include "drivers/p3dx/p3dx_node.hpp"
#include "services/common/process/command_line.hpp"

using namespace luminav;

int main(int argc, char** argv) {
  return run_guarded("p3dx", [&] {
    std::string robot;
    std::string device;
    std::string url;
    std::string state;
    CommandLine line("p3dx", "Drives a Pioneer P3-DX: ODOMETRY, SONAR and ROBOT_STATUS out, VELOCITY_COMMAND in");
    line.robot_file(robot).text("--device", device, "tcp:HOST:PORT or a serial device, instead of the robot file's");
    line.lcm_url(url).state_folder(state);
    if (const auto status = line.parse(argc, argv)) {
      return *status;
    }
    P3dxConfig config = read_p3dx_config(robot);
    config.device = device.empty() ? config.device : device;
    config.state_folder = std::filesystem::path(state) / config.robot.name;
    const OpenStream opener = stream_opener(config.device, config.baud);
    const auto lcm = open_lcm(url);
    const HostClock clock;
    P3dxNode node(*lcm, config, clock, opener);
    EventLoop loop(*lcm, "p3dx", config.robot.name);
    loop.watch([&] { return node.descriptor(); }, [&] { node.poll(); });
    loop.every(10'000, [&] { node.poll(); });
    loop.report_health([&] { return node.health(); });
    const int status = loop.run();
    node.shut_down();
    return status;
  });
}
