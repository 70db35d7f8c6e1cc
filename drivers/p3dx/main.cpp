#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <functional>
#include <string>

#include "drivers/p3dx/p3dx_node.hpp"
#include "drivers/p3dx/safety/guardian.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/urgency.hpp"

using namespace luminav;

namespace {

constexpr const char* kGuardianDied =
    "its guardian has died: it stops the robot and ends, to be started again with another";

/// Tells the guardian which line to hold, and the user what happens to the line.
class Watch {
 public:
  Watch(P3dxNode& node, Guardian& guardian, const Clock& clock) : node_(node), guardian_(guardian), clock_(clock) {}

  void report_connection(std::function<void()> changed) { connection_changed_ = std::move(changed); }
  void poll() {
    node_.poll();
    if (node_.connected() != connected_) {
      connected_ = node_.connected();
      connection_changed_();
    }
    const int openings = node_.descriptor() >= 0 ? node_.link().openings() : 0;
    if (openings != guarded_) {
      guarded_ = openings;
      guardian_.watch_line(node_.descriptor());
    }
    const std::int64_t now = clock_.utime();
    if (now - last_look_ < kLookPeriod) {
      return;
    }
    last_look_ = now;
    const std::string line = node_.describe_line();
    if (line != said_) {
      said_ = line;
      fmt::print(stderr, "p3dx: {}\n", line);
    }
  }

  Health health() const {
    Health health = node_.health();
    if (!guardian_.alive()) {
      health.fault = true;
      health.reason = kGuardianDied;
    }
    return health;
  }

 private:
  static constexpr std::int64_t kLookPeriod = 55'000;  // [us] with every third poll
  P3dxNode& node_;
  Guardian& guardian_;
  const Clock& clock_;
  std::int64_t last_look_ = 0;  // [us]
  int guarded_ = 0;             // which opening of the line
  bool connected_ = false;
  std::function<void()> connection_changed_ = [] {};
  std::string said_;
};

OpenStream open_by_configuration(const P3dxConfig& config) {
  try {
    return stream_opener(config.device, config.baud);
  } catch (const std::invalid_argument& error) {
    throw ConfigurationError(error.what());
  }
}

/// The robot brakes before its motors are switched off.
void bring_to_rest(P3dxNode& node, Watch& watch) {
  constexpr int kSteps = 150;  // of 10 ms
  for (int i = 0; i < kSteps && !node.stand_still(); ++i) {
    poll(nullptr, 0, 10);
    watch.poll();
  }
  node.shut_down();
}

}  // namespace

int main(int argc, char** argv) {
  return run_guarded("p3dx", [&] {
    std::string robot;
    std::string device;
    std::string url;
    std::string state;
    double max_speed = 0.0;
    CommandLine line("p3dx", "Drives a Pioneer P3-DX: ODOMETRY, SONAR and ROBOT_STATUS out, VELOCITY_COMMAND in");
    line.robot_file(robot).text("--device", device, "tcp:HOST:PORT or a serial device, instead of the robot file's");
    line.number("--max-speed", max_speed, "[m/s] go no faster, whatever the robot file allows; 0 = as it says");
    line.lcm_url(url).state_folder(state);
    if (const auto status = line.parse(argc, argv)) {
      return *status;
    }
    P3dxConfig config = read_p3dx_config(robot);
    config.device = device.empty() ? config.device : device;
    config.state_folder = std::filesystem::path(state) / config.robot.name;
    if (max_speed < 0.0) {
      throw ConfigurationError(fmt::format("--max-speed {}: must be at least 0 m/s", max_speed));
    }
    if (max_speed > 0.0) {
      config.robot.limits.linear = std::min(config.robot.limits.linear, max_speed);
    }
    const OpenStream opener = open_by_configuration(config);
    const MotionLimits& limits = config.robot.limits;
    const GuardianParams guarding{.brake_time = limits.linear / limits.linear_deceleration + 0.3};
    constexpr double kFarewell = 0.15;  // [s] in which it ends the session
    config.guardian_silence = guarding.silence;
    config.guardian_done_after = guarding.silence + guarding.brake_time + kFarewell;
    claim_urgency();  // the guardian inherits it
    Guardian guardian(guarding);
    const NetworkAccess access = read_network_access(robot);
    const LcmNetwork network = access.on(url);
    const auto lcm = open_lcm(network);
    const HostClock clock;
    P3dxNode node(*lcm, config, clock, opener, access.key);
    node.report_life([&] { guardian.beat(); });
    receive_only(*lcm, network, node.channels());
    Watch watch(node, guardian, clock);
    EventLoop loop(*lcm, "p3dx", config.robot.name, network);
    loop.belong_to(identify(robot, ""));
    loop.watch([&] { return node.descriptor(); }, [&] { watch.poll(); });
    loop.every(20'000, [&] {
      node.hold(loop.conflict());
      watch.poll();
      if (!guardian.alive()) {  // nobody would stop the robot should this process die, too
        loop.check_health();
        loop.stop();
      }
    });
    loop.report_health([&] { return watch.health(); });
    watch.report_connection([&] { loop.check_health(); });
    const int status = loop.run();
    bring_to_rest(node, watch);
    if (!guardian.alive()) {
      fmt::print(stderr, "p3dx: {}\n", kGuardianDied);
      return 1;
    }
    return status;
  });
}
