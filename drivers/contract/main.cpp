#include <fmt/format.h>
#include <poll.h>

#include <cstdio>
#include <string>

#include "drivers/contract/check_base_node.hpp"
#include "services/common/configuration/robot_base.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/interrupts.hpp"

using namespace luminav;

namespace {

/// Hands over messages as they come, so that their arrivals are true, until the time is over or the exercise is done.
void listen(lcm::LCM& lcm, const CheckBaseNode& node, const Clock& clock, double duration) {
  const auto end = clock.utime() + static_cast<std::int64_t>(1e6 * duration);
  std::string said;
  while (!is_interrupted() && clock.utime() < end && !(node.exercise() && node.exercise()->is_done())) {
    constexpr int kTick = 100;  // [ms]
    pollfd descriptor{lcm.getFileno(), POLLIN, 0};
    if (poll(&descriptor, 1, kTick) > 0 && lcm.handleTimeout(0) < 0) {
      throw std::runtime_error("the LCM network failed");
    }
    if (node.exercise() && node.exercise()->doing() != said) {
      said = node.exercise()->doing();
      fmt::print(stderr, "check-base: {}\n", said);
    }
  }
}

int judge(const CheckBaseNode& node, bool drives) {
  const std::vector<Clause> clauses = node.clauses();
  fmt::print("{}", describe(clauses));
  if (node.exercise() && !node.exercise()->refusal().empty()) {
    throw std::runtime_error(node.exercise()->refusal());
  }
  if (node.exercise() && !node.exercise()->is_done()) {
    throw std::runtime_error("it did not come to its end: ROBOT_STATUS is missing, or somebody interrupted it");
  }
  const int status = exit_status(clauses, drives);
  fmt::print("check-base: {}\n",
             status == 0 ? "it keeps the contract, as far as it was seen" : "it does not keep the contract");
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  return run_guarded("check-base", [&] {
    std::string robot_file;
    std::string url;
    CheckBaseOptions options{.process = "", .drives = false, .key = {}};
    double duration = 10.0;
    CommandLine line("check-base",
                     "Watches a running base driver and says of each clause of the contract (docs/base-drivers.md) "
                     "whether it holds. Exit status 1 = one does not.");
    line.robot_file(robot_file)
        .text("--process", options.process, "the driver's name in NODE_STATUS, instead of the robot file's base")
        .flag("--drive", options.drives,
              "move the robot, for 41 s: turns on the spot, 0.2 m forth and back, STOP, motors off and on; no "
              "controller may run")
        .number("--duration", duration, "[s] to listen where nothing is driven")
        .lcm_url(url);
    if (const auto status = line.parse(argc, argv)) {
      return *status;
    }
    if (!(duration >= 3.0 && duration <= 86400.0)) {
      throw ConfigurationError(fmt::format("--duration = {}, must be 3 to 86400 s", duration));
    }
    const RobotDescription robot = read_robot(robot_file);
    options.process = options.process.empty() ? read_robot_base(robot_file) : options.process;
    const NetworkAccess access = read_network_access(robot_file);
    options.key = access.key;
    const auto lcm = open_lcm(access.on(url));
    const HostClock clock;
    const CheckBaseNode node(*lcm, robot, clock, options);
    constexpr double kPatience = 90.0;  // [s] twice what the exercise takes
    catch_interrupts();
    listen(*lcm, node, clock, options.drives ? kPatience : duration);
    return judge(node, options.drives);
  });
}
