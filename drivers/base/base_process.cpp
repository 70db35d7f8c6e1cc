#include "drivers/base/base_process.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>

#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/urgency.hpp"

namespace luminav {
namespace {

constexpr const char* kGuardianDied =
    "its guardian has died: it stops the robot and ends, to be started again with another";

/// Tells the guardian which line to hold, and the user what happens to the line.
class Watch {
 public:
  Watch(const std::string& process, BaseDriver& driver, Guardian& guardian, const Clock& clock)
      : process_(process), driver_(driver), guardian_(guardian), clock_(clock) {}

  void report_connection(std::function<void()> changed) { connection_changed_ = std::move(changed); }
  void poll() {
    driver_.poll();
    if (driver_.connected() != connected_) {
      connected_ = driver_.connected();
      connection_changed_();
    }
    const int openings = driver_.descriptor() >= 0 ? driver_.openings() : 0;
    if (openings != guarded_) {
      guarded_ = openings;
      guardian_.watch_line(driver_.descriptor());
    }
    const std::int64_t now = clock_.utime();
    if (now - last_look_ < kLookPeriod) {
      return;
    }
    last_look_ = now;
    const std::string line = driver_.describe_line();
    if (line != said_) {
      said_ = line;
      fmt::print(stderr, "{}: {}\n", process_, line);
    }
  }

  Health health() const {
    Health health = driver_.health();
    if (!guardian_.alive()) {
      health.fault = true;
      health.reason = kGuardianDied;
    }
    return health;
  }

 private:
  static constexpr std::int64_t kLookPeriod = 55'000;  // [us] with every third poll
  std::string process_;
  BaseDriver& driver_;
  Guardian& guardian_;
  const Clock& clock_;
  std::int64_t last_look_ = 0;  // [us]
  int guarded_ = 0;             // which opening of the line
  bool connected_ = false;
  std::function<void()> connection_changed_ = [] {};
  std::string said_;
};

/// The robot brakes before its motors are switched off.
void bring_to_rest(BaseDriver& driver, Watch& watch) {
  constexpr int kSteps = 150;  // of 10 ms
  for (int i = 0; i < kSteps && !driver.stand_still(); ++i) {
    poll(nullptr, 0, 10);
    watch.poll();
  }
  driver.shut_down();
}

}  // namespace

std::optional<int> BaseOptions::parse(const std::string& process, const std::string& does, int argc, char** argv) {
  CommandLine line(process, does);
  line.robot_file(robot_file).text("--device", device, "tcp:HOST:PORT or a serial device, instead of the robot file's");
  line.number("--max-speed", max_speed, "[m/s] go no faster, whatever the robot file allows; 0 = as it says");
  line.lcm_url(url).state_folder(state);
  return line.parse(argc, argv);
}

void BaseOptions::limit(MotionLimits& limits) const {
  if (max_speed < 0.0) {
    throw ConfigurationError(fmt::format("--max-speed {}: must be at least 0 m/s", max_speed));
  }
  if (max_speed > 0.0) {
    limits.linear = std::min(limits.linear, max_speed);
  }
}

GuardianParams BaseOptions::apply_to(BaseConfig& config) const {
  config.device = device.empty() ? config.device : device;
  config.state_folder = std::filesystem::path(state) / config.robot.name;
  limit(config.robot.limits);
  const GuardianParams guarding{.brake_time = brake_time_of(config.robot.limits)};
  config.guardian_silence = guarding.silence;
  config.guardian_done_after = done_after_of(guarding);
  return guarding;
}

OpenStream open_by_configuration(const std::string& device, int baud) {
  try {
    return stream_opener(device, baud);
  } catch (const std::invalid_argument& error) {
    throw ConfigurationError(error.what());
  }
}

double brake_time_of(const MotionLimits& limits) {
  return limits.linear / limits.linear_deceleration + 0.3;
}

double done_after_of(const GuardianParams& guarding) {
  constexpr double kFarewell = 0.15;  // [s] in which it ends the session
  return guarding.silence + guarding.brake_time + kFarewell;
}

int run_base(const std::string& process, const BaseOptions& options, const std::string& robot,
             const GuardedRobot& guarded, const GuardianParams& guarding, const MakeDriver& make_driver) {
  claim_urgency();  // the guardian inherits it
  Guardian guardian(guarding, guarded);
  const NetworkAccess access = read_network_access(options.robot_file);
  const LcmNetwork network = access.on(options.url);
  const auto lcm = open_lcm(network);
  const HostClock clock;
  const std::unique_ptr<BaseDriver> driver = make_driver(*lcm, clock, access.key);
  driver->report_life([&] { guardian.beat(); });
  receive_only(*lcm, network, driver->channels());
  Watch watch(process, *driver, guardian, clock);
  EventLoop loop(*lcm, process, robot, network);
  loop.belong_to(options.robot_file);
  loop.watch([&] { return driver->descriptor(); }, [&] { watch.poll(); });
  loop.every(20'000, [&] {
    driver->hold(loop.conflict());
    watch.poll();
    if (!guardian.alive()) {  // nobody would stop the robot should this process die, too
      loop.check_health();
      loop.stop();
    }
  });
  loop.report_health([&] { return watch.health(); });
  watch.report_connection([&] { loop.check_health(); });
  const int status = loop.run();
  bring_to_rest(*driver, watch);
  if (!guardian.alive()) {
    fmt::print(stderr, "{}: {}\n", process, kGuardianDied);
    return 1;
  }
  return status;
}

}  // namespace luminav
