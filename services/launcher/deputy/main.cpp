#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "services/common/configuration/toml_table.hpp"
#include "services/common/network/network_access.hpp"
#include "services/common/process/command_line.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/launcher/deputy/deputy.hpp"
#include "services/launcher/deputy/processes/posix_runner.hpp"
#include "services/launcher/network.hpp"
#include "services/launcher/service_notice.hpp"

namespace {

using namespace luminav;

std::optional<std::string> from_environment(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  return value != nullptr ? std::optional<std::string>(value) : std::nullopt;
}

std::int64_t make_nonce() {
  const launcher::Instant now = launcher::Instant::read();
  return (now.utime << 16) | (getpid() & 0xffff);
}

void end_like_sigterm(int) {
  kill(getpid(), SIGTERM);
}

int run(int argc, char** argv) {
  launcher::DeputyConfig config;
  std::vector<std::string> files;
  std::string url = launcher::default_procman_url();
  std::string robot_file;
  std::string logs;
  std::string state;
  std::int64_t respawn_limit = config.respawn.limit;
  std::int64_t memory_limit = 1000;  // [MB]
  CommandLine line("deputy", "Starts, stops and watches the processes of this machine by order of a sheriff.");
  line.list("--config", files, "process configuration (.pmd); its commands for this deputy are the ones it may run");
  line.flag("--allow-any", config.allow_any,
            "run whatever anybody on the network orders: only on a network of your own");
  line.text("--id", config.id, "name of this deputy, as in the configuration");
  line.text("--lcm-url", url, "LCM network of deputies and sheriffs; default $LUMINAV_PROCMAN_URL");
  line.launched_robot(robot_file);
  line.text("--log-dir", logs, "folder for the log files; default STATE/log/ID");
  line.integer("--respawn-limit", respawn_limit,
               "restarts in a row after which a process that dies again stays stopped");
  line.integer("--memory-limit", memory_limit, "[MB] a process that uses more is ended, and started again; 0 = none");
  line.state_folder(state);
  if (const std::optional<int> status = line.parse(argc, argv)) {
    return *status;
  }
  if (files.empty() && !config.allow_any) {
    throw ConfigurationError("no commands to run: give --config FILE (or --allow-any)");
  }
  for (const std::string& file : files) {
    const launcher::PmdFile pmd = launcher::read_pmd(file);
    config.allowed.insert(config.allowed.end(), pmd.commands.begin(), pmd.commands.end());
  }
  if (respawn_limit < 0 || respawn_limit > 1'000'000) {
    throw ConfigurationError(fmt::format("--respawn-limit is {}, expected 0 to 1000000", respawn_limit));
  }
  config.respawn.limit = static_cast<int>(respawn_limit);
  if (memory_limit < 0 || memory_limit > 1'000'000) {
    throw ConfigurationError(fmt::format("--memory-limit is {} MB, expected 0 to 1000000", memory_limit));
  }
  config.memory_limit = memory_limit * 1'000'000;
  config.log_folder = logs.empty() ? std::filesystem::path(state) / "log" / config.id : std::filesystem::path(logs);
  config.nonce = make_nonce();
  config.environment = from_environment;

  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  setenv("LUMINAV_BIN", folder.c_str(), 0);
  launcher::PosixRunner runner(folder);  // before LCM makes its thread
  const NetworkAccess access = read_network_access(robot_file);
  config.key = access.key;
  const auto lcm = open_lcm(access.on(url));
  EventLoop loop(*lcm, "deputy", "", access.on(url));
  signal(SIGHUP, end_like_sigterm);
  signal(SIGQUIT, end_like_sigterm);
  launcher::Deputy deputy(*lcm, config, runner);
  deputy.report_notices([](const std::string& notice) { fmt::print(stderr, "deputy: {}\n", notice); });

  bool ending = false;
  const auto tick = [&] {
    deputy.tick(launcher::Instant::read());
    if (deputy.conflict() || (ending && deputy.all_stopped())) {
      loop.stop();
    }
  };
  loop.every(50'000, tick);
  loop.every(1'000'000, [] { launcher::tell_service_manager("WATCHDOG=1"); });
  loop.watch([&] { return runner.event_descriptor(); }, tick);
  loop.watch([&] { return lcm->getFileno(); }, tick);  // answers at once, not with the next period
  loop.report_health(
      [&] { return Health{.degraded = false, .fault = false, .reason = "", .dropped_inputs = deputy.dropped()}; });
  int status = loop.run();
  if (deputy.conflict()) {
    throw ConfigurationError(*deputy.conflict());
  }
  ending = true;
  deputy.begin_shutdown();
  while (status == 0 && !deputy.all_stopped()) {
    status = loop.run();
  }
  deputy.tick(launcher::Instant::read());  // the last PM_INFO and output
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  return luminav::run_guarded("deputy", [&] { return run(argc, argv); });
}
