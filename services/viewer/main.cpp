#include <fmt/format.h>
#include <sys/random.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/launcher/network.hpp"
#include "services/viewer/http_rules.hpp"
#include "services/viewer/http_server.hpp"
#include "services/viewer/process_desk.hpp"
#include "services/viewer/viewer_node.hpp"

namespace luminav {
namespace {

std::string random_hex(std::size_t count) {
  std::vector<unsigned char> bytes(count);
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the kernel gives no random numbers");
  }
  std::string hex;
  for (const unsigned char byte : bytes) {
    hex += fmt::format("{:02x}", byte);
  }
  return hex;
}

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "localhost";
}

int view(int argc, char** argv) {
  std::string robot_file, building_file, url;
  std::string procman_url = launcher::default_procman_url();
  HttpOptions http;
  std::int64_t port = http.port;
  std::int64_t command_port = -1;
  CommandLine line("viewer", "Shows in any browser what the robot believes, and takes goals and stops.");
  line.robot_file(robot_file).building_file(building_file).lcm_url(url);
  line.text("--listen", http.listen,
            "address to serve on; others than 127.0.0.1 reach beyond this machine and demand a token")
      .integer("--port", port, "of the page, 0 = any free one")
      .integer("--command-port", command_port, "of the commands alone (default: the next one)")
      .text("--procman-url", procman_url, "LCM network of deputies and sheriffs; default $LUMINAV_PROCMAN_URL")
      .text("--web", http.web_folder, "folder to read the page from instead of the built-in one");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  command_port = command_port >= 0 ? command_port : (port == 0 ? 0 : port + 1);
  if (port < 0 || port > 65535 || command_port > 65535) {
    throw ConfigurationError("--port and --command-port must be 0 to 65535");
  }
  http.port = static_cast<int>(port);
  http.command_port = static_cast<int>(command_port);
  http.host_name = host_name();
  http.token = is_loopback(http.listen) ? "" : random_hex(12);

  const ViewerConfig config = read_viewer_config(robot_file, building_file);
  const HostClock clock;
  const NetworkAccess access = read_network_access(robot_file);
  const LcmNetwork network = access.on(url);
  const auto lcm = open_lcm(network);
  SnapshotBoard board;
  PictureStore pictures;
  const auto procman = open_lcm(access.on(procman_url));
  RequestDesk desk(*lcm, fmt::format("viewer@{}:{}-{}", http.host_name, getpid(), random_hex(4)), access.key);
  Helm helm(*lcm, config.robot.limits, access.key);
  ProcessDesk processes(*procman, *lcm, access.key);
  ViewerNode node(*lcm, config, clock, board, pictures, desk, helm);
  const HttpServer server(http, {board, pictures, desk, helm, processes, clock, config.building, config.robot});
  fmt::print("viewer: open {}\n", server.address());
  std::fflush(stdout);

  EventLoop loop(*lcm, "viewer", config.robot.name, network);
  loop.belong_to(identify(robot_file, building_file));
  limit_memory(1500);  // the stacks of a hundred threads count
  loop.report_health([&] { return node.health(); });
  loop.every(100'000, [&] {
    if (server.listeners() > 0) {
      node.show();
    }
  });
  loop.every(200'000, [&] {
    desk.object(loop.objection());
    desk.repeat(clock.utime());
  });
  loop.watch([&] { return procman->getFileno(); },
             [&] {
               while (procman->handleTimeout(0) > 0) {
               }
             });
  loop.every(50'000, [&] { processes.tick(launcher::Instant::read()); });
  loop.every(1'000'000, [&] {
    node.show_processes();
    board.put(SnapshotBoard::Lane::kLive, "processes", server_sent_event("processes", processes.json()));
  });
  return loop.run();
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("viewer", [&] { return luminav::view(argc, argv); });
}
