#include "services/launcher/deputy/processes/child_start.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

extern char** environ;

namespace luminav::launcher {
namespace {

struct Terminal {
  int ours = -1;
  int theirs = -1;
};

Terminal open_terminal() {
  Terminal terminal;
  terminal.ours = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  std::array<char, 128> name{};
  if (terminal.ours < 0 || grantpt(terminal.ours) != 0 || unlockpt(terminal.ours) != 0 ||
      ptsname_r(terminal.ours, name.data(), name.size()) != 0 ||
      (terminal.theirs = open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC)) < 0) {
    const int reason = errno;
    close(terminal.ours);
    throw std::runtime_error(fmt::format("no terminal for a child process: {}", std::strerror(reason)));
  }
  termios settings{};
  if (tcgetattr(terminal.theirs, &settings) == 0) {
    settings.c_oflag &= ~static_cast<tcflag_t>(ONLCR);  // lines end as the program ends them
    settings.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    tcsetattr(terminal.theirs, TCSANOW, &settings);
  }
  return terminal;
}

std::vector<std::string> make_environment(const CommandWords& command, const std::filesystem::path& program_folder) {
  std::vector<std::string> result;
  const auto is_replaced = [&](const std::string& entry) {
    for (const auto& [name, value] : command.environment) {
      if (entry.starts_with(name + "=")) {
        return true;
      }
    }
    return entry.starts_with("PATH=");
  };
  for (char** entry = environ; *entry != nullptr; ++entry) {
    if (!is_replaced(*entry)) {
      result.emplace_back(*entry);
    }
  }
  const char* path = std::getenv("PATH");
  std::string search = program_folder.string() + ":" + (path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin");
  for (const auto& [name, value] : command.environment) {
    if (name == "PATH") {
      search = value;
    } else {
      result.push_back(name + "=" + value);
    }
  }
  result.push_back("PATH=" + search);
  return result;
}

/// Where the program may be, in the order of PATH; resolved before the fork because little may be done after it.
std::vector<std::string> candidates(const std::string& program, const std::vector<std::string>& environment) {
  if (program.find('/') != std::string::npos) {
    return {program};
  }
  std::vector<std::string> result;
  const std::string path = environment.back().substr(std::strlen("PATH="));
  for (std::size_t start = 0; start <= path.size();) {
    const std::size_t end = std::min(path.find(':', start), path.size());
    if (end > start) {
      result.push_back(path.substr(start, end - start) + "/" + program);
    }
    start = end + 1;
  }
  return result;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  for (std::string& text : texts) {
    result.push_back(text.data());
  }
  result.push_back(nullptr);
  return result;
}

struct ChildPlan {
  std::vector<char*> programs, arguments, environment;  // each ends with nullptr
  int terminal;
  pid_t deputy;
};

void say(const char* text) {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, std::strlen(text));
}

/// Between fork and exec: only what is safe in a child of a program with threads.
[[noreturn]] void become(const ChildPlan& plan) {
  setsid();
  ioctl(plan.terminal, TIOCSCTTY, 0);
  for (int descriptor = 0; descriptor < 3; ++descriptor) {
    dup2(plan.terminal, descriptor);
  }
  close_range(3, ~0U, 0);
  // A deputy that a script started with & ignores SIGINT; its children must not.
  struct sigaction standard {};
  standard.sa_handler = SIG_DFL;
  for (int number = 1; number < NSIG; ++number) {
    sigaction(number, &standard, nullptr);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  // A service's protection from running out of memory is the deputy's, and of those who take it again (claim_urgency).
  if (const int score = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC); score >= 0) {
    [[maybe_unused]] const ssize_t written = write(score, "0", 1);
    close(score);
  }
  rlimit memory{};
  if (getrlimit(RLIMIT_DATA, &memory) == 0) {  // the deputy's own limit is not theirs
    memory.rlim_cur = memory.rlim_max;
    setrlimit(RLIMIT_DATA, &memory);
  }
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != plan.deputy) {
    _exit(255);  // it died before the line above
  }
  int reason = ENOENT;
  for (char* const program : plan.programs) {
    if (program == nullptr) {
      break;
    }
    execve(program, plan.arguments.data(), plan.environment.data());
    reason = errno == EACCES || reason == ENOENT ? errno : reason;
  }
  say("cannot run ");
  say(plan.arguments[0]);
  say(reason == ENOENT    ? ": no such program\n"
      : reason == EACCES  ? ": no permission to run it\n"
      : reason == ENOEXEC ? ": not a program\n"
                          : ": the system refuses\n");
  _exit(255);
}

}  // namespace

StartedChild start_child(const CommandWords& command, const std::filesystem::path& program_folder) {
  std::vector<std::string> environment = make_environment(command, program_folder);
  std::vector<std::string> programs = candidates(command.words.front(), environment);
  std::vector<std::string> arguments = command.words;
  const Terminal terminal = open_terminal();
  const ChildPlan plan{pointers(programs), pointers(arguments), pointers(environment), terminal.theirs, getpid()};
  const pid_t pid = fork();
  if (pid == 0) {
    become(plan);
  }
  const int reason = errno;
  close(terminal.theirs);
  if (pid < 0) {
    close(terminal.ours);
    throw std::runtime_error(fmt::format("cannot start a process: {}", std::strerror(reason)));
  }
  return {pid, terminal.ours};
}

}  // namespace luminav::launcher
