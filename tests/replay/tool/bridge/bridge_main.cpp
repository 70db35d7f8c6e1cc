#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <exception>
#include <lcm/lcm-cpp.hpp>
#include <set>
#include <string>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/common/configuration/shipped_file.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "tests/replay/tool/bridge/foxglove_server.hpp"
#include "tests/replay/tool/mcap/foxglove_export.hpp"

namespace luminav {
namespace {

/// Hears every channel and passes on what comes. LCM survives no exception.
class Tap {
 public:
  Tap(lcm::LCM& lcm, FoxgloveExport& converter) : converter_(converter) {
    lcm.subscribe(".*", &Tap::on_message, this)->setQueueCapacity(1000);
  }
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  void on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    constexpr std::size_t kMaxChannels = 500;  // a stranger may invent names without end
    if (channels_.size() >= kMaxChannels && !channels_.contains(channel)) {
      ++dropped_;
      return;
    }
    channels_.insert(channel);
    try {
      const auto* data = static_cast<const std::uint8_t*>(buffer->data);
      converter_.add({buffer->recv_utime, channel, {data, data + buffer->data_size}});
    } catch (const std::exception&) {
      ++dropped_;
    }
  }

  FoxgloveExport& converter_;
  std::set<std::string> channels_;
  std::int64_t dropped_ = 0;
};

int bridge(int argc, char** argv) {
  FoxgloveServerOptions options;
  options.kept_topics = {"/map", "/path", "/tf_static"};
  std::string robot_file, url;
  std::int64_t port = options.port;
  std::int64_t longest = 64;
  CommandLine line("bridge",
                   "Shows a running robot live in Foxglove and Lichtblick, by Foxglove's WebSocket protocol.");
  line.lcm_url(url)
      .launched_robot(robot_file)
      .text("--listen", options.listen, "address to serve on; others than 127.0.0.1 reach beyond this machine")
      .integer("--port", port, "0 = any free one")
      .list("--origin", options.origins,
            "of a page elsewhere that may listen, such as https://app.foxglove.dev; several times")
      .integer("--longest", longest, "elements of an array that are sent; pictures and tiles are left out");
  if (const auto status = line.parse(argc, argv)) {
    return *status;
  }
  if (port < 0 || port > 65535 || longest < 1 || longest > 10'000) {
    throw ConfigurationError("--port must be 0 to 65535, --longest 1 to 10000");
  }
  options.port = static_cast<int>(port);
  std::array<char, 256> host{};
  options.host_name = gethostname(host.data(), host.size() - 1) == 0 ? host.data() : "localhost";
  const RobotDescription robot = read_robot(robot_file.empty() ? shipped_file("robots/p3dx.toml") : robot_file);
  const LcmNetwork network = read_network_access(robot_file).on(url);
  const auto lcm = open_lcm(network);
  FoxgloveServer server(options);
  FoxgloveExport converter(server, robot, static_cast<std::size_t>(longest));
  const Tap tap(*lcm, converter);
  fmt::print("bridge: open ws://{}:{} in Foxglove or Lichtblick (\"Foxglove WebSocket\")\n", options.listen,
             server.port());
  std::fflush(stdout);

  EventLoop loop(*lcm, "bridge", robot.name, network);
  loop.every(20'000, [&] { server.poll(); });
  loop.report_health([&] {
    Health health;
    health.dropped_inputs = tap.dropped();
    health.reason = fmt::format("{} clients", server.clients());
    if (server.lost() > 0) {
      health.reason += fmt::format(", {} messages left out for slow ones", server.lost());
    }
    return health;
  });
  return loop.run();
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  return luminav::run_guarded("bridge", [&] { return luminav::bridge(argc, argv); });
}
