#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <luminav/supervision_t.hpp>
#include <map>
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
#include "services/common/process/interrupts.hpp"
#include "services/operator/goal_order.hpp"
#include "services/operator/goal_target.hpp"
#include "services/operator/job_command.hpp"
#include "services/operator/robot_order.hpp"
#include "services/operator/system_files.hpp"
#include "services/operator/system_snapshot.hpp"
#include "services/operator/terminal.hpp"

namespace luminav {
namespace {

// A person who waits here should see the robot; Ctrl-C stops it.
void say_somebody_watches(CommandPublisher& commands) {
  supervision_t supervision{};
  supervision.utime = new_id();
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
    listen_until(lcm, monotonic_us() + kTick);
    if (take_interrupt()) {
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
  listen_until(*lcm, monotonic_us() + kPatience);
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
      .positional("target", words,
                  "PLACE, or X Y [HEADING] in metres, world frame; the heading in radians, or as 90deg", true);
  if (const auto status = command_line.parse(argc, argv)) {
    return *status;
  }
  const std::optional<std::vector<double>> numbers = read_point(words);
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

goal_t action_goal(std::int8_t action) {
  goal_t goal{};
  goal.id = goal.utime = new_id();
  goal.action = action;
  return goal;
}

/// A command about the goal that is under way; status 0 when it ended as it should.
int run_goal_action(int argc, char** argv, const std::string& does, std::int8_t action, Outcome good) {
  std::string url, robot_file;
  CommandLine command_line(argv[0], does);
  if (const auto status = command_line.lcm_url(url).launched_robot(robot_file).parse(argc, argv)) {
    return *status;
  }
  const NetworkAccess access = read_network_access(robot_file);
  const auto lcm = open_lcm(access.on(url));
  GoalOrder request(*lcm, action_goal(action), access.key);
  const int status = watch(*lcm, CommandPublisher(*lcm, access.key), request);
  return status == static_cast<int>(good) ? 0 : status;
}

/// Repeats a request until it is obeyed, a STOP without end, others for ten seconds.
int carry_out(lcm::LCM& lcm, RobotWish wish, const std::string& done, std::optional<CommandKey> key) {
  constexpr std::int64_t kTick = 200'000;         // [us]
  constexpr std::int64_t kPatience = 10'000'000;  // [us]
  RobotOrder order(lcm, wish, new_id(), fmt::format("terminal:{}", getpid()), key);
  ProgressLine line;
  const std::int64_t end = monotonic_us() + kPatience;
  const auto is_done = [&] { return order.is_obeyed() && (wish != RobotWish::kStop || order.stands()); };
  while (!is_done() && !is_interrupted()) {
    order.tick();
    listen_until(lcm, monotonic_us() + kTick);
    if (!order.is_obeyed()) {
      line.show(order.progress());
    }
    if (wish != RobotWish::kStop && monotonic_us() > end) {
      break;
    }
  }
  line.end();
  fmt::print("{}\n", is_done() ? done : order.is_obeyed() ? "obeyed, but it still moves" : order.progress());
  return is_done() ? 0 : is_interrupted() ? 130 : 1;
}

int run_stop(int argc, char** argv) {
  std::string url, robot_file;
  CommandLine command_line("stop", "Stops the robot, and keeps it stopped until somebody releases the stop.");
  if (const auto status = command_line.lcm_url(url).launched_robot(robot_file).parse(argc, argv)) {
    return *status;
  }
  const NetworkAccess access = read_network_access(robot_file);
  const auto lcm = open_lcm(access.on(url));
  return carry_out(*lcm, RobotWish::kStop, "the robot stands; scripts/release lets it move again", access.key);
}

/// Pauses a goal that is under way; false when the planner does not.
bool pause_goal(lcm::LCM& lcm, const NetworkAccess& access) {
  GoalOrder request(lcm, action_goal(goal_t::ACTION_PAUSE), access.key);
  const Outcome outcome{watch(lcm, CommandPublisher(lcm, access.key), request)};
  return outcome == Outcome::kPaused || outcome == Outcome::kNothingToDo;
}

int run_release(int argc, char** argv) {
  std::string url, robot_file;
  bool goes_on = false;
  CommandLine command_line("release", "Lets a stopped robot move again; a goal stays paused until scripts/resume.");
  command_line.flag("--go-on", goes_on, "drive on to the goal at once");
  if (const auto status = command_line.lcm_url(url).launched_robot(robot_file).parse(argc, argv)) {
    return *status;
  }
  const NetworkAccess access = read_network_access(robot_file);
  const auto lcm = open_lcm(access.on(url));
  if (!goes_on && !pause_goal(*lcm, access)) {
    throw std::runtime_error(
        "the planner does not pause its goal, so the stop is kept; --go-on releases it all the same");
  }
  return carry_out(*lcm, RobotWish::kRelease, "released", access.key);
}

int run_motors(int argc, char** argv) {
  std::string url, robot_file;
  std::vector<std::string> words;
  CommandLine command_line("motors", "Switches the robot's motors on or off.");
  command_line.lcm_url(url).launched_robot(robot_file).positional("state", words, "on | off", true);
  if (const auto status = command_line.parse(argc, argv)) {
    return *status;
  }
  if (words.size() != 1 || (words.front() != "on" && words.front() != "off")) {
    throw ConfigurationError("say on or off");
  }
  const NetworkAccess access = read_network_access(robot_file);
  const auto lcm = open_lcm(access.on(url));
  const bool on = words.front() == "on";
  return carry_out(*lcm, on ? RobotWish::kMotorsOn : RobotWish::kMotorsOff, "motors: asked for " + words.front(),
                   access.key);
}

int run_status(int argc, char** argv) {
  std::string url, robot_file;
  bool as_json = false, watches = false;
  CommandLine command_line("status", "Prints what the robot and its processes say of themselves.");
  command_line.flag("--json", as_json, "for programs").flag("--watch", watches, "again each second, until Ctrl-C");
  if (const auto status = command_line.lcm_url(url).launched_robot(robot_file).parse(argc, argv)) {
    return *status;
  }
  const NetworkAccess access = read_network_access(robot_file);
  const auto lcm = open_lcm(access.on(url));
  do {
    const SystemSnapshot snapshot(*lcm);  // anew each time: a process that fell silent is not shown as if it spoke
    listen_until(*lcm, monotonic_us() + 1'300'000);  // each process reports once a second
    if (watches && !as_json && isatty(STDOUT_FILENO) != 0) {
      fmt::print("\033[H\033[2J");
    }
    if (as_json) {
      fmt::print("{}\n", snapshot.json());
    } else if (snapshot.is_empty()) {
      fmt::print("nothing is running on {}\n", url);
    } else {
      fmt::print("{}{}\n", snapshot.page(), describe(access, url));
    }
    std::fflush(stdout);
    if (!watches && snapshot.is_empty()) {
      return 1;
    }
  } while (watches && !is_interrupted());
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

int run_cancel(int argc, char** argv) {
  return run_goal_action(argc, argv, "Makes the robot give up its goal and stand still.", goal_t::ACTION_CANCEL,
                         Outcome::kCancelled);
}

int run_pause(int argc, char** argv) {
  return run_goal_action(argc, argv, "Makes the robot stand and keep its goal.", goal_t::ACTION_PAUSE,
                         Outcome::kPaused);
}

int run_resume(int argc, char** argv) {
  return run_goal_action(argc, argv, "Makes the robot go on with a paused goal.", goal_t::ACTION_RESUME,
                         Outcome::kResumed);
}

int run(int argc, char** argv) {
  const std::string command = argc > 1 ? argv[1] : "";
  static const std::map<std::string, int (*)(int, char**)> kCommands = {
      {"goto", run_goto},   {"cancel", run_cancel},   {"pause", run_pause},   {"resume", run_resume},
      {"stop", run_stop},   {"release", run_release}, {"motors", run_motors}, {"status", run_status},
      {"files", run_files}, {"job", run_job}};
  if (const auto found = kCommands.find(command); found != kCommands.end()) {
    return found->second(argc - 1, argv + 1);
  }
  if (command == "--version") {
    fmt::print("operator (luminav) {}\n", kVersion);
    return 0;
  }
  const bool asks_help = command == "-h" || command == "--help";
  fmt::print(
      asks_help ? stdout : stderr,
      "operator goto (PLACE | X Y [HEADING]) | status | cancel | pause | resume | stop | release | motors (on | off) | "
      "job ORDER | files;\n"
      "each has --help\n"
      "goto exits 0 when arrived, 1 nobody answers, 2 wrong usage, 3 no path, 4 blocked, 5 stuck, 6 cancelled,\n"
      "7 lost, 8 replaced by another goal, 9 the planner fell silent, 130 interrupted (the goal is cancelled)\n");
  return asks_help ? 0 : 2;
}

}  // namespace
}  // namespace luminav

int main(int argc, char** argv) {
  luminav::catch_interrupts();
  return luminav::run_guarded(argc > 1 ? argv[1] : "operator", [&] { return luminav::run(argc, argv); });
}
