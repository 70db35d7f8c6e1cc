#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <luminav/supervision_t.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "services/common/configuration/building_file.hpp"
#include "services/common/configuration/toml_table.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/operator/goal_order.hpp"
#include "services/operator/goal_target.hpp"
#include "services/operator/system_files.hpp"
#include "services/operator/system_snapshot.hpp"

namespace luminav {
namespace {

volatile sig_atomic_t g_interrupted = 0;

void on_interrupt(int) {
  g_interrupted = 1;
}

std::int64_t clock_us(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000 + now.tv_nsec / 1000;
}

// Ids of requests must grow from one call to the next, also after a reboot: the wall clock.
std::int64_t new_id() {
  return clock_us(CLOCK_REALTIME);
}

// Hands over messages until `end` [us, monotonic] or an interruption.
void listen_until(lcm::LCM& lcm, std::int64_t end) {
  while (g_interrupted == 0) {
    const std::int64_t left = end - clock_us(CLOCK_MONOTONIC);
    if (left <= 0) {
      return;
    }
    pollfd descriptor{lcm.getFileno(), POLLIN, 0};
    if (poll(&descriptor, 1, static_cast<int>(left / 1000 + 1)) > 0 && lcm.handleTimeout(0) < 0) {
      throw std::runtime_error("the LCM network failed");
    }
  }
}

// Rewrites one line on a terminal; elsewhere a line only when it says something new.
class ProgressLine {
 public:
  void show(const std::string& text) {
    if (isatty(STDOUT_FILENO) != 0) {
      fmt::print("\r\033[K{}", text);
      std::fflush(stdout);
    } else if (clock_us(CLOCK_MONOTONIC) - shown_ > 2'000'000 && text != last_) {
      fmt::print("{}\n", text);
      std::fflush(stdout);
      shown_ = clock_us(CLOCK_MONOTONIC);
    }
    last_ = text;
  }
  void end() const {
    if (isatty(STDOUT_FILENO) != 0 && !last_.empty()) {
      fmt::print("\n");
    }
  }

 private:
  std::string last_;
  std::int64_t shown_ = 0;  // [us]
};

// A person who waits here should see the robot; Ctrl-C stops it.
void say_somebody_watches(CommandPublisher& commands) {
  supervision_t supervision{};
  supervision.utime = clock_us(CLOCK_REALTIME);
  supervision.sender = "operator";
  commands.publish(channels::kSupervision, supervision);
}

int watch(lcm::LCM& lcm, CommandPublisher commands, GoalOrder& request) {
  constexpr std::int64_t kTick = 200'000;  // [us]
  ProgressLine line;
  bool was_interrupted = false;
  while (!request.outcome()) {
    request.tick();
    say_somebody_watches(commands);
    listen_until(lcm, clock_us(CLOCK_MONOTONIC) + kTick);
    if (g_interrupted != 0) {
      g_interrupted = 0;
      if (was_interrupted) {
        break;  // asked twice: do not wait for the planner
      }
      was_interrupted = true;
      request.cancel(new_id());
    }
    line.show(was_interrupted ? "cancelling" : request.progress());
  }
  line.end();
  const Outcome outcome = was_interrupted ? Outcome::kInterrupted : request.outcome().value_or(Outcome::kInterrupted);
  fmt::print("{}{}{}\n", to_string(outcome), request.cause().empty() ? "" : ": ", request.cause());
  return static_cast<int>(outcome);
}

// Listens until each process has said which files it has.
FilePaths files_of_what_runs(const LcmNetwork& network, const FilePaths& asked) {
  constexpr std::int64_t kPatience = 1'300'000;  // [us] each process reports once a second
  std::unique_ptr<lcm::LCM> lcm;
  try {
    lcm = open_lcm(network);
  } catch (const std::runtime_error&) {
    return choose_files({}, asked);  // nothing can run there
  }
  const SystemListener listener(*lcm);
  listen_until(*lcm, clock_us(CLOCK_MONOTONIC) + kPatience);
  return choose_files(listener.system(), asked);
}

int run_goto(int argc, char** argv) {
  std::string url, robot_file;
  std::string building_file;
  std::vector<std::string> words;
  double tolerance = 0.0;
  CommandLine command_line("goto",
                           "Sends the robot to a place of the building or to a point, and waits until it is there.");
  command_line.text("--building", building_file,
                    "building file (TOML) that knows the places; default: the running system's");
  command_line.number("--tolerance", tolerance, "metres within which it counts as reached; 0 = the planner's");
  command_line.lcm_url(url)
      .launched_robot(robot_file)
      .positional("target", words, "PLACE, or X Y [THETA] in metres and radians, world frame", true);
  if (const auto status = command_line.parse(argc, argv)) {
    return *status;
  }
  const std::optional<std::vector<double>> numbers = read_numbers(words);
  const NetworkAccess access = read_network_access(robot_file);
  // A building is needed for places only; one that was named must be the running one, as must those of all processes.
  if (!numbers || !building_file.empty()) {
    building_file = files_of_what_runs(access.on(url), {"", building_file}).building;
  }
  if (!numbers && building_file.empty()) {
    throw ConfigurationError("a place is known by its building only: give --building FILE");
  }
  goal_t goal = make_goal(words, numbers ? Building{} : read_building(building_file));
  goal.id = goal.utime = new_id();
  goal.tolerance = tolerance;
  const auto lcm = open_lcm(access.on(url));
  GoalOrder request(*lcm, goal, access.key);
  return watch(*lcm, CommandPublisher(*lcm, access.key), request);
}

int run_cancel(int argc, char** argv) {
  std::string url, robot_file;
  CommandLine command_line("cancel", "Makes the robot give up its goal and stand still.");
  if (const auto status = command_line.lcm_url(url).launched_robot(robot_file).parse(argc, argv)) {
    return *status;
  }
  goal_t goal{};
  goal.id = goal.utime = new_id();
  goal.action = goal_t::ACTION_CANCEL;
  const NetworkAccess access = read_network_access(robot_file);
  const auto lcm = open_lcm(access.on(url));
  GoalOrder request(*lcm, goal, access.key);
  const int status = watch(*lcm, CommandPublisher(*lcm, access.key), request);
  return status == static_cast<int>(Outcome::kCancelled) ? 0 : status;
}

int run_status(int argc, char** argv) {
  std::string url, robot_file;
  CommandLine command_line("status", "Prints what the robot and its processes say of themselves.");
  if (const auto status = command_line.lcm_url(url).launched_robot(robot_file).parse(argc, argv)) {
    return *status;
  }
  const NetworkAccess access = read_network_access(robot_file);
  const auto lcm = open_lcm(access.on(url));
  const SystemSnapshot snapshot(*lcm);
  // each process reports once a second
  listen_until(*lcm, clock_us(CLOCK_MONOTONIC) + 1'300'000);
  if (snapshot.is_empty()) {
    fmt::print("nothing is running on {}\n", url);
    return 1;
  }
  fmt::print("{}{}\n", snapshot.page(), describe(access, url));
  return 0;
}

int run_files(int argc, char** argv) {
  std::string url;
  FilePaths asked;
  CommandLine command_line("files",
                           "Prints the paths of the running system's robot and building, one a line; where nothing "
                           "runs, of those that would be launched.");
  command_line.text("--robot", asked.robot, "must be the running one").text("--building", asked.building, "the same");
  if (const auto status = command_line.lcm_url(url).parse(argc, argv)) {
    return *status;
  }
  const FilePaths files = files_of_what_runs(url, asked);
  fmt::print("{}\n{}\n", files.robot, files.building);
  return 0;
}

int run(int argc, char** argv) {
  const std::string command = argc > 1 ? argv[1] : "";
  if (command == "goto") {
    return run_goto(argc - 1, argv + 1);
  }
  if (command == "cancel") {
    return run_cancel(argc - 1, argv + 1);
  }
  if (command == "status") {
    return run_status(argc - 1, argv + 1);
  }
  if (command == "files") {
    return run_files(argc - 1, argv + 1);
  }
  if (command == "--version") {
    fmt::print("operator (luminav) {}\n", kVersion);
    return 0;
  }
  const bool asks_help = command == "-h" || command == "--help";
  fmt::print(
      asks_help ? stdout : stderr,
      "operator goto (PLACE | X Y [THETA]) | status | cancel | files; each has --help\n"
      "goto exits 0 when arrived, 1 nobody answers, 2 wrong usage, 3 no path, 4 blocked, 5 stuck, 6 cancelled,\n"
      "7 lost, 8 replaced by another goal, 9 the planner fell silent, 130 interrupted (the goal is cancelled)\n");
  return asks_help ? 0 : 2;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  struct sigaction action {};
  action.sa_handler = luminav::on_interrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  sigaction(SIGHUP, &action, nullptr);  // a terminal that is closed must not leave the robot driving
  return luminav::run_guarded(argc > 1 ? argv[1] : "operator", [&] { return luminav::run(argc, argv); });
}
