#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/channel_filter.hpp"
#include "services/common/process/channels.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/interrupts.hpp"
#include "services/launcher/deputy/rotating_log.hpp"
#include "services/launcher/network.hpp"
#include "services/launcher/sheriff/session.hpp"

namespace {

using namespace luminav;
using namespace luminav::launcher;

constexpr int kFailed = 1;
constexpr int kInterrupted = 130;
constexpr double kPatience = 3.0;  // [s] deputies answer within a fifth of a second, or say so once a second

struct Options {
  std::string config, action, target;
  std::string robot_file;  // for its table [network]
  std::string script, procman_url = default_procman_url(), data_url, state, deputy;
  double wait_limit = 30.0;
  bool observe = false, stay = false, stop_on_exit = false, follow = false;
};

bool is_action(const std::string& word) {
  constexpr std::array kActions = {"status", "start", "stop", "restart", "log"};
  return std::find(kActions.begin(), kActions.end(), word) != kActions.end();
}

/// [CONFIG] [ACTION [TARGET]]
void read_words(std::vector<std::string> words, Options& options) {
  if (!words.empty() && !is_action(words.front())) {
    options.config = words.front();
    words.erase(words.begin());
  }
  if (!words.empty()) {
    options.action = words[0];
    if (!is_action(options.action)) {
      throw ConfigurationError(fmt::format("found '{}', expected status, start, stop, restart or log", options.action));
    }
    options.target = words.size() > 1 ? words[1] : "";
  }
  if (words.size() > 2) {
    throw ConfigurationError(fmt::format("found '{}' after the target, expected nothing", words[2]));
  }
  if (options.action.empty() && options.config.empty() && !options.observe) {
    throw ConfigurationError(
        "expected a configuration (.pmd), an action (status, start, stop, restart, log) or --observe");
  }
  if (!options.script.empty() && (options.config.empty() || !options.action.empty() || options.observe)) {
    throw ConfigurationError("--script needs a configuration, and neither an action nor --observe");
  }
  if ((options.action == "restart" || options.action == "log") && options.target.empty()) {
    throw ConfigurationError(fmt::format("expected {} NAME", options.action));
  }
  if (!(options.wait_limit > 0)) {
    throw ConfigurationError(fmt::format("--wait-limit is {}, expected more than 0 s", options.wait_limit));
  }
}

Target find_target(const Sheriff& sheriff, const std::string& name) {
  if (name.empty() || name == "everything") {
    return {};
  }
  for (const Target::Kind kind : {Target::Kind::kCommand, Target::Kind::kGroup}) {
    const Target target{kind, name};
    if (sheriff.knows(target)) {
      return target;
    }
  }
  throw ConfigurationError(fmt::format("there is no command or group \"{}\"", name));
}

/// Until every deputy that is needed has been heard, or patience ends. False for Ctrl-C.
bool look_round(Session& session, const Sheriff& sheriff, bool configured) {
  const std::int64_t end = Instant::read().steady + static_cast<std::int64_t>(kPatience * 1e6);
  // Without a configuration nobody knows how many there are: listen for as long as they take to repeat themselves.
  const std::int64_t min = configured ? 0 : end - static_cast<std::int64_t>((kPatience - 1.2) * 1e6);
  return session.run_until(
      [&] {
        const std::int64_t now = Instant::read().steady;
        return now >= end || (now >= min && !sheriff.deputies().empty() && sheriff.deputies_heard({}));
      },
      false);
}

int show_status(Session& session, const Sheriff& sheriff) {
  // NODE_STATUS comes once a second.
  if (!session.run_for(1.2)) {
    return kInterrupted;
  }
  session.show_table();
  const std::vector<CommandState> states = sheriff.states();
  const bool all_well = std::all_of(states.begin(), states.end(), [](const CommandState& state) {
    return state.condition == Condition::kReady || state.condition == Condition::kStopped;
  });
  return all_well && !states.empty() ? 0 : kFailed;
}

int show_log(Session& session, Sheriff& sheriff, const Options& options) {
  sheriff.report_output([&](const std::string&, const std::string& command, const std::string& text) {
    if (command == options.target) {
      fmt::print("{}", text);
      std::fflush(stdout);
    }
  });
  const std::filesystem::path folder = std::filesystem::path(options.state) / "log";
  std::error_code ignored;
  bool found = false;
  for (std::filesystem::directory_iterator deputy(folder, ignored), end; !ignored && deputy != end;
       deputy.increment(ignored)) {
    const bool asked = options.deputy.empty() || deputy->path().filename() == options.deputy;
    std::ifstream file(deputy->path() / log_file_name(options.target));
    if (!asked || !file) {
      continue;
    }
    found = true;
    constexpr std::streamoff kMax = 16'000;  // [bytes]
    file.seekg(0, std::ios::end);
    const std::streamoff size = file.tellg();
    file.seekg(std::max<std::streamoff>(0, size - kMax));
    std::string line;
    if (size > kMax) {
      std::getline(file, line);  // its beginning is missing
    }
    while (std::getline(file, line)) {
      fmt::print("{}\n", line);
    }
  }
  std::fflush(stdout);
  if (found && !options.follow) {
    return 0;
  }
  if (!found && !options.follow) {
    session.print(fmt::format("no log file of {} under {}; --follow shows what it prints from now on", options.target,
                              folder.string()));
    return kFailed;
  }
  session.run_until([] { return false; }, false);
  return 0;
}

int act(Session& session, Sheriff& sheriff, const Options& options) {
  const Target target = find_target(sheriff, options.target);
  Action action;
  action.target = target;
  action.kind = options.action == "start"  ? Action::Kind::kStart
                : options.action == "stop" ? Action::Kind::kStop
                                           : Action::Kind::kRestart;
  action.await = options.action == "stop" ? AwaitedStatus::kStopped : AwaitedStatus::kRunning;
  ScriptRun run(sheriff, action, options.wait_limit);
  const std::optional<bool> success = session.run_script(run, true);
  if (!success) {
    session.print(fmt::format("interrupted; {} was ordered to {} and will", to_string(target), options.action));
    return kInterrupted;
  }
  if (!*success) {
    session.print(run.message());
  }
  return *success ? 0 : kFailed;
}

enum class Stopping { kAllStopped, kOrdered, kNotAll };

/// Waits until all of it stands; an interrupt ends the waiting, not the order.
Stopping stop_all(Session& session, Sheriff& sheriff, const std::vector<Target>& targets) {
  Stopping result = Stopping::kAllStopped;
  for (const Target& target : targets) {
    Action action;
    action.kind = Action::Kind::kStop;
    action.target = target;
    action.await = AwaitedStatus::kStopped;
    ScriptRun run(sheriff, action, 15.0);
    const std::optional<bool> success = session.run_script(run, false);
    if (!success && result == Stopping::kAllStopped) {
      result = Stopping::kOrdered;
    } else if (success && !*success) {
      result = Stopping::kNotAll;
    }
  }
  return result;
}

/// The person's sheriff: a script if asked for, then the table until Ctrl-C.
int command(Session& session, Sheriff& sheriff, const PmdFile& file, const Options& options) {
  int status = 0;
  bool interrupted = false;
  if (!options.script.empty()) {
    ScriptRun run(sheriff, file, options.script, options.wait_limit);
    const std::optional<bool> success = session.run_script(run, true);
    interrupted = !success;
    status = !success ? kInterrupted : *success ? 0 : kFailed;
    if (interrupted && !options.stop_on_exit) {
      session.print("interrupted: stopping what the script has started");
      stop_all(session, sheriff, run.started());
    } else if (success) {
      session.print(*success ? fmt::format("script \"{}\" succeeded", options.script)
                             : fmt::format("script \"{}\" failed: {}", options.script, run.message()));
    }
  }
  if (!interrupted && (options.script.empty() || options.stay)) {
    session.run_until([] { return false; }, true);
  }
  if (options.stop_on_exit) {
    session.print("stopping everything");
    Target everything;
    const Stopping stopping = stop_all(session, sheriff, {everything});
    if (stopping == Stopping::kNotAll) {
      session.print("not everything could be stopped");
      return kFailed;
    }
    if (stopping == Stopping::kOrdered) {
      session.print("interrupted again: everything was ordered to stop and will, nobody waits for it");
      return kInterrupted;
    }
  } else if (options.script.empty() || options.stay) {
    session.print("the processes go on; `sheriff stop` stops them");
  }
  return status;
}

int run(int argc, char** argv) {
  Options options;
  std::vector<std::string> words;
  CommandLine line("sheriff", "Starts, stops and watches the processes of a configuration on all its machines.");
  line.positional(
      "words", words,
      "[CONFIG] [status | start [T] | stop [T] | restart T | log NAME], T = a command, a group or everything");
  line.text("--script", options.script, "run this script of CONFIG; the exit status says whether it succeeded");
  line.flag("--stay", options.stay, "go on watching after the script");
  line.flag("--stop-on-exit", options.stop_on_exit, "stop everything at the end; without it the processes go on");
  line.flag("--observe", options.observe, "only watch, never order");
  line.number("--wait-limit", options.wait_limit, "seconds that a wait may take");
  line.flag("--follow", options.follow, "with log: go on showing what is printed");
  line.text("--deputy", options.deputy, "with log: only of this deputy");
  line.text("--procman-url", options.procman_url, "LCM network of deputies and sheriffs; default $LUMINAV_PROCMAN_URL");
  line.lcm_url(options.data_url);
  line.launched_robot(options.robot_file);
  line.state_folder(options.state);
  if (const std::optional<int> status = line.parse(argc, argv)) {
    return *status;
  }
  read_words(words, options);
  const PmdFile file = options.config.empty() ? PmdFile{} : read_pmd(options.config);

  const NetworkAccess access = read_network_access(options.robot_file);
  const auto procman = open_lcm(access.on(options.procman_url));
  const auto data = open_lcm(access.on(options.data_url));
  limit_memory(512);
  catch_interrupts();
  const bool only_looks = options.observe || options.action == "status" || options.action == "log";
  Sheriff sheriff(*procman, file, {.id = make_sheriff_id(Instant::read()), .observe = only_looks, .key = access.key});
  sheriff.listen_for_readiness(*data);
  receive_only(*data, access.on(options.data_url),  // with its own channels, should both networks be one
               {channels::kNodeStatus, channels::kProcmanInfo, channels::kProcmanOrders, channels::kProcmanOutput,
                channels::kProcmanDiscover});
  Session session(*procman, data.get(), sheriff);
  if (options.action.empty()) {
    sheriff.report_notices([&](const std::string& notice) { session.print(notice); });
  }
  sheriff.tick(Instant::read());
  if (options.action == "log") {
    return show_log(session, sheriff, options);
  }
  if (!look_round(session, sheriff, !options.config.empty())) {
    return kInterrupted;
  }
  if (options.action == "status") {
    return show_status(session, sheriff);
  }
  return options.action.empty() ? command(session, sheriff, file, options) : act(session, sheriff, options);
}

}  // namespace

int main(int argc, char** argv) {
  return luminav::run_guarded("sheriff", [&] { return run(argc, argv); });
}
