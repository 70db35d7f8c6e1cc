#include "tests/system/faults/hosts/test_host.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "services/launcher/instant.hpp"

namespace luminav {
namespace {

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') {
      result += '\\';
    }
    result += letter;
  }
  return result + '"';
}

void write_pmd(const std::filesystem::path& file, const launcher::PmdFile& commands, const std::string& deputy) {
  std::ofstream out(file);
  for (const launcher::Command& command : commands.commands) {
    out << fmt::format("cmd {} {{\n  deputy = {};\n  exec = {};\n}}\n", quoted(command.name), quoted(deputy),
                       quoted(command.exec));
  }
}

}  // namespace

std::filesystem::path program_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

TestHost::TestHost(Setup setup, const launcher::PmdFile& commands) : setup_(std::move(setup)) {
  std::filesystem::create_directories(setup_.folder / "run");
  setup_.environment.try_emplace("LUMINAV_STATE", setup_.folder.string());
  write_pmd(setup_.folder / "allowed.pmd", commands, setup_.id);
}

TestHost::~TestHost() {
  stop();
}

void TestHost::start() {
  const std::string deputy = setup_.environment.at("LUMINAV_BIN") + "/deputy";
  const std::string config = (setup_.folder / "allowed.pmd").string();
  const std::string limit = std::to_string(setup_.memory_limit);
  const std::string said = (setup_.folder / "deputy.txt").string();
  const pid_t parent = getpid();
  const InsideHost inside(setup_.network);
  deputy_ = fork();
  if (deputy_ < 0) {
    throw std::runtime_error("cannot start a deputy");
  }
  if (deputy_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) {
      _exit(1);
    }
    setpgid(0, 0);  // Ctrl-C is for the test, which stops the rest in order
    for (const auto& [name, value] : setup_.environment) {
      setenv(name.c_str(), value.c_str(), 1);
    }
    const int null = open("/dev/null", O_RDONLY);
    const int file = open(said.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    dup2(null, 0);
    dup2(file, 1);
    dup2(file, 2);
    execl(deputy.c_str(), "deputy", "--config", config.c_str(), "--id", setup_.id.c_str(), "--lcm-url",
          setup_.procman_url.c_str(), "--state", setup_.folder.c_str(), "--memory-limit", limit.c_str(), nullptr);
    _exit(127);
  }
}

void TestHost::kill_deputy() {
  if (deputy_ > 0) {
    kill(deputy_, SIGKILL);
    waitpid(deputy_, nullptr, 0);
    deputy_ = -1;
  }
}

void TestHost::stop() {
  if (deputy_ <= 0) {
    return;
  }
  kill(deputy_, SIGTERM);
  const std::int64_t until = launcher::Instant::read().steady + 10 * launcher::kSecond;
  while (waitpid(deputy_, nullptr, WNOHANG) == 0) {
    if (launcher::Instant::read().steady > until) {
      kill_deputy();
      return;
    }
    ::poll(nullptr, 0, 20);
  }
  deputy_ = -1;
}

}  // namespace luminav
