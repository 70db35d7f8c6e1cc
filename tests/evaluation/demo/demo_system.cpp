#include "tests/evaluation/demo/demo_system.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <poll.h>
#include <array>
#include <cerrno>
#include <deque>
#include <fstream>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "services/common/configuration/robot_file.hpp"
#include "services/common/configuration/shipped_file.hpp"
#include "services/common/configuration/whole_file.hpp"
#include "services/common/network/lcm_network.hpp"
#include "services/common/process/event_loop.hpp"
#include "services/common/process/interrupts.hpp"
#include "services/launcher/network.hpp"
#include "services/launcher/sheriff/script_run.hpp"
#include "services/launcher/sheriff/session.hpp"

namespace luminav {
namespace {

constexpr double kReadyWithin = 30.0;    // [s]
constexpr double kStoppedWithin = 10.0;  // [s]
constexpr int kArcosPort = 8101;

std::filesystem::path program_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

/// The robot's usual port, on a further network one of its own beyond the pages' ports, if nobody has it, else any free
/// one: demos that start at the same moment do not choose the same.
int free_port(const std::string& lcm_url) {
  constexpr int kUsualNetwork = 7667;
  const auto network = multicast_address(lcm_url);
  const int apart = network ? static_cast<int>(network->port) - kUsualNetwork : 0;
  const int own = kArcosPort + (apart > 0 && apart <= 1000 ? 1000 + apart : 0);
  for (const int wanted : {own, 0}) {
    const int descriptor = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int yes = 1;
    setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(wanted));
    socklen_t size = sizeof(address);
    const bool is_free = bind(descriptor, reinterpret_cast<sockaddr*>(&address), size) == 0;
    getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size);
    close(descriptor);
    if (is_free) {
      return ntohs(address.sin_port);
    }
  }
  throw std::runtime_error("no free TCP port for the simulated robot");
}

/// Two demos on two networks need two for their orders as well: LUMINAV_PROCMAN_URL, else the port above the data's.
std::string procman_url_beside(const std::string& lcm_url) {
  const auto data = multicast_address(lcm_url);
  if (std::getenv("LUMINAV_PROCMAN_URL") == nullptr && data) {
    in_addr group{data->group};
    const std::string url = fmt::format("udpm://{}:{}?ttl=0", inet_ntoa(group), data->port + 1);
    setenv("LUMINAV_PROCMAN_URL", url.c_str(), 1);
  }
  return launcher::default_procman_url();
}

/// Starts a child that gets no terminal input and dies with this process.
pid_t start_child(const std::vector<std::string>& words, const std::filesystem::path& output) {
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) {
    throw std::runtime_error(fmt::format("cannot start {}", words.front()));
  }
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) {
      _exit(1);
    }
    setpgid(0, 0);  // Ctrl-C in the terminal is for the demo, which stops the rest in order
    const int null = open("/dev/null", O_RDONLY);
    const int file = open(output.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    dup2(null, 0);
    dup2(file, 1);
    dup2(file, 2);
    std::vector<char*> arguments;
    for (const std::string& word : words) {
      arguments.push_back(const_cast<char*>(word.c_str()));
    }
    arguments.push_back(nullptr);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  return child;
}

void end_child(pid_t& child, double seconds) {
  if (child <= 0) {
    return;
  }
  kill(child, SIGTERM);
  const std::int64_t until = launcher::Instant::read().steady + static_cast<std::int64_t>(seconds * 1e6);
  while (waitpid(child, nullptr, WNOHANG) == 0) {
    if (launcher::Instant::read().steady > until) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
      break;
    }
    ::poll(nullptr, 0, 20);
  }
  child = -1;
}

}  // namespace

DemoSystem::DemoSystem(const Scenario& scenario, const std::string& mode, const std::string& lcm_url,
                       const std::string& log_file) {
  std::string folder = (std::filesystem::temp_directory_path() / "luminav-demo-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) {
    throw std::runtime_error(fmt::format("{}: cannot be made", folder));
  }
  state_folder_ = folder;
  const std::string port = std::to_string(free_port(lcm_url));
  const std::string seed = std::to_string(scenario.seed);
  const std::string state = state_folder_.string();
  for (const auto& [name, value] : std::vector<std::pair<const char*, std::string>>{
           {"LUMINAV_BIN", program_folder().string()},
           {"LUMINAV_SCENARIO", scenario.file.string()},
           {"LUMINAV_ROBOT", robot_file_in_mode(scenario.robot_file, mode).string()},
           {"LUMINAV_BUILDING", scenario.building_file.string()},
           {"LUMINAV_SIMULATOR_PORT", port},
           {"LUMINAV_SEED", seed},
           {"LUMINAV_LCM_URL", lcm_url},
           {"LUMINAV_STATE", state}}) {
    setenv(name, value.c_str(), 1);
  }
  configuration_ = launcher::read_pmd(configuration_for(scenario.base));
  const std::string procman_url = procman_url_beside(lcm_url);
  procman_ = open_lcm(procman_url);
  start_deputy(procman_url);
  if (!log_file.empty()) {
    start_recorder(scenario, lcm_url, log_file);
  }
  sheriff_ = std::make_unique<launcher::Sheriff>(
      *procman_, configuration_, launcher::SheriffConfig{launcher::make_sheriff_id(launcher::Instant::read()), false});
  sheriff_->report_notices([](const std::string& notice) { fmt::print(stderr, "demo: {}\n", notice); });
}

DemoSystem::~DemoSystem() {
  end_child(deputy_, 10.0);
  end_child(recorder_, 5.0);
  end_child(viewer_, 5.0);
  std::error_code ignored;
  std::filesystem::remove_all(state_folder_, ignored);
}

/// The robot's file with another mode, beside what else the demo keeps for its time.
std::filesystem::path DemoSystem::robot_file_in_mode(const std::filesystem::path& file, const std::string& mode) const {
  if (mode.empty()) {
    return file;
  }
  const std::filesystem::path copy = state_folder_ / "robot.toml";
  write_whole_file(copy.string(), with_mode(read_whole_file(file.string()), mode));
  return copy;
}

/// demo.pmd with the driver of that base in the place of the p3dx's, beside what else the demo keeps for its time.
std::filesystem::path DemoSystem::configuration_for(const std::string& base) const {
  const std::filesystem::path shipped = shipped_file("demo.pmd");
  if (base == "p3dx") {
    return shipped;
  }
  std::string text = read_whole_file(shipped.string());
  for (const auto& [ours, its] : {std::pair{std::string("cmd \"p3dx\""), "cmd \"" + base + "\""},
                                  {"LUMINAV_BIN/p3dx ", "LUMINAV_BIN/" + base + " "}}) {
    text.replace(text.find(ours), ours.size(), its);
  }
  const std::filesystem::path copy = state_folder_ / "demo.pmd";
  write_whole_file(copy.string(), text);
  return copy;
}

void DemoSystem::start_deputy(const std::string& procman_url) {
  deputy_ = start_child({(program_folder() / "deputy").string(), "--config", configuration_.file, "--id", "localhost",
                         "--lcm-url", procman_url, "--log-dir", (state_folder_ / "log").string()},
                        state_folder_ / "deputy.log");
}

void DemoSystem::start_recorder(const Scenario& scenario, const std::string& lcm_url, const std::string& log_file) {
  const std::filesystem::path installed = program_folder() / "record";
  const std::string record =
      std::filesystem::exists(installed) ? installed.string() : LUMINAV_SOURCE_DIR "/scripts/record";
  recorder_ = start_child({record, "--at-once", log_file, "--lcm-url", lcm_url, "--robot", scenario.robot_file.string(),
                           "--building", scenario.building_file.string()},
                          state_folder_ / "record.log");
}

void DemoSystem::start_viewer(const Scenario& scenario, const std::string& lcm_url, int port) {
  viewer_ = start_child({(program_folder() / "viewer").string(), "--robot", scenario.robot_file.string(), "--building",
                         scenario.building_file.string(), "--lcm-url", lcm_url, "--port", std::to_string(port)},
                        state_folder_ / "view.log");
}

std::string DemoSystem::last_words(const std::string& process) const {
  std::string last;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(state_folder_)) {
    if (entry.path().filename().string().starts_with(process)) {
      std::ifstream in(entry.path());
      for (std::string line; std::getline(in, line);) {
        if (!line.empty()) {
          last = line;
        }
      }
    }
  }
  return last;
}

void DemoSystem::pump(lcm::LCM& data) {
  std::array<pollfd, 2> descriptors{{{data.getFileno(), POLLIN, 0}, {procman_->getFileno(), POLLIN, 0}}};
  ::poll(descriptors.data(), descriptors.size(), 20);
  for (lcm::LCM* lcm : {&data, procman_.get()}) {
    while (lcm->handleTimeout(0) > 0) {
    }
  }
  sheriff_->tick(launcher::Instant::read());
}

bool DemoSystem::is_whole() {
  for (const auto& [child, name, log] :
       {std::tuple{&deputy_, "deputy", "deputy"}, {&recorder_, "recorder", "record"}, {&viewer_, "page", "view"}}) {
    if (*child > 0 && waitpid(*child, nullptr, WNOHANG) == *child) {
      *child = -1;
      failure_ = fmt::format("the {} ended: {}", name, last_words(log));
      return false;
    }
  }
  return true;
}

bool DemoSystem::start(lcm::LCM& data) {
  sheriff_->listen_for_readiness(data);
  launcher::ScriptRun script(*sheriff_, configuration_, "go", kReadyWithin);
  while (true) {
    if (take_interrupt()) {
      return false;
    }
    pump(data);
    if (!is_whole()) {
      return false;
    }
    switch (script.step(launcher::Instant::read().steady)) {
      case launcher::ScriptRun::Progress::kSucceeded:
        return true;
      case launcher::ScriptRun::Progress::kFailed:
        failure_ = script.message();
        for (const launcher::CommandState& state : sheriff_->states()) {
          const std::string words = state.pid == 0 ? last_words(state.name) : "";
          failure_ += words.empty() ? "" : fmt::format("\n  {}: {}", state.name, words);
        }
        return false;
      case launcher::ScriptRun::Progress::kGoingOn:
        break;
    }
  }
}

void DemoSystem::stop() {
  if (deputy_ > 0) {
    launcher::ScriptRun script(*sheriff_, configuration_, "stop", kStoppedWithin);
    while (script.step(launcher::Instant::read().steady) == launcher::ScriptRun::Progress::kGoingOn) {
      while (procman_->handleTimeout(20) > 0) {
      }
      sheriff_->tick(launcher::Instant::read());
    }
  }
  end_child(deputy_, 10.0);
  end_child(recorder_, 5.0);
  end_child(viewer_, 5.0);
}

void DemoSystem::kill_process(const std::string& name) {
  for (const launcher::CommandState& state : sheriff_->states()) {
    if (state.name == name && state.pid > 0) {
      kill(state.pid, SIGKILL);
    }
  }
}

}  // namespace luminav
