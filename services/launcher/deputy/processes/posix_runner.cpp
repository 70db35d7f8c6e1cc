#include "services/launcher/deputy/processes/posix_runner.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/epoll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>

#include "services/launcher/deputy/processes/child_start.hpp"
#include "services/launcher/deputy/processes/proc_files.hpp"
#include "services/launcher/instant.hpp"

namespace luminav::launcher {
namespace {

/// A descendant that made a session of its own did so to outlive its parent for a moment, as the guardian of a robot's
/// driver does, which has to bring the robot to a stop.
constexpr std::int64_t kLingering = 5 * kSecond;

bool is_in_session(int pid, int session) {
  const std::optional<ProcessStat> stat = read_process_stat(pid);
  return stat.has_value() && stat->session == session;
}

}  // namespace

PosixRunner::PosixRunner(std::filesystem::path program_folder)
    : program_folder_(std::move(program_folder)), epoll_(epoll_create1(EPOLL_CLOEXEC)) {
  if (epoll_ < 0) {
    throw std::runtime_error("cannot watch child processes: epoll is not available");
  }
  // Grandchildren whose parent died come to us, so that we can end them.
  prctl(PR_SET_CHILD_SUBREAPER, 1);
}

PosixRunner::~PosixRunner() {
  for (auto& [pid, child] : children_) {
    signal(pid, SIGKILL);
    kill(-pid, SIGKILL);
  }
  for (auto& [pid, child] : children_) {
    while (waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
    }
    end_left_behind(pid, child);
    close_child(child);
  }
  while (!lingering_.empty()) {
    constexpr int kPause = 20;  // [ms]
    poll(nullptr, 0, kPause);
    while (waitpid(-1, nullptr, WNOHANG) > 0) {
    }
    kill_lingering();
  }
  close(epoll_);
}

int PosixRunner::start(const CommandWords& command) {
  const StartedChild started = start_child(command, program_folder_);
  guard_.watch(started.pid);
  Child child;
  child.terminal = started.terminal;
  child.pidfd = static_cast<int>(syscall(SYS_pidfd_open, started.pid, 0));
  epoll_event event{};
  event.events = EPOLLIN;
  epoll_ctl(epoll_, EPOLL_CTL_ADD, child.terminal, &event);
  if (child.pidfd >= 0) {
    epoll_ctl(epoll_, EPOLL_CTL_ADD, child.pidfd, &event);
  }
  children_.emplace(started.pid, std::move(child));
  return started.pid;
}

void PosixRunner::signal(int pid, int signal) {
  const auto found = children_.find(pid);
  if (found == children_.end()) {
    return;  // reaped: the number may belong to a stranger by now
  }
  const std::vector<int> descendants = descendants_of(pid);
  kill(pid, signal);  // before those it waits for: else it could end as if all were well
  for (const int descendant : descendants) {
    found->second.descendants.insert(descendant);
    if (is_in_session(descendant, pid)) {
      kill(descendant, signal);
    } else if (signal != SIGKILL) {
      kill(descendant, SIGTERM);  // never one that it cannot choose what to do about
    }
  }
}

void PosixRunner::read_terminal(int pid, Child& child, std::vector<ProcessOutput>& outputs) {
  std::array<char, 4096> buffer{};
  constexpr int kReadsAtOnce = 64;  // a program that prints without pause must not stop the deputy
  for (int i = 0; i < kReadsAtOnce && child.terminal >= 0; ++i) {
    const ssize_t count = read(child.terminal, buffer.data(), buffer.size());
    if (count > 0) {
      outputs.push_back({pid, std::string(buffer.data(), static_cast<std::size_t>(count))});
    } else if (count < 0 && (errno == EAGAIN || errno == EINTR)) {
      return;
    } else {
      // EIO: nobody holds the other end any more
      close(child.terminal);
      child.terminal = -1;
    }
  }
}

std::vector<ProcessOutput> PosixRunner::take_output() {
  std::vector<ProcessOutput> outputs = std::move(last_words_);
  last_words_.clear();
  for (auto& [pid, child] : children_) {
    read_terminal(pid, child, outputs);
  }
  return outputs;
}

std::vector<ProcessExit> PosixRunner::take_exits() {
  std::vector<ProcessExit> exits;
  int status = 0;
  for (pid_t pid = 0; (pid = waitpid(-1, &status, WNOHANG)) > 0;) {
    const auto found = children_.find(pid);
    if (found == children_.end()) {
      continue;  // somebody's orphan
    }
    end_left_behind(pid, found->second);
    read_terminal(pid, found->second, last_words_);
    close_child(found->second);
    children_.erase(found);
    guard_.forget(pid);
    exits.push_back({pid, status});
  }
  kill_lingering();
  return exits;
}

bool PosixRunner::is_orphan_of_ours(int pid) const {
  const std::optional<ProcessStat> stat = read_process_stat(pid);
  return stat && stat->parent == getpid() && stat->state != 'Z' && !children_.contains(pid) && pid != guard_.pid();
}

void PosixRunner::end_left_behind(int pid, const Child& child) {
  kill(-pid, SIGKILL);
  std::set<int> left = child.descendants;
  for (const int orphan : children_of(getpid())) {
    if (is_in_session(orphan, pid)) {
      left.insert(orphan);
    }
  }
  for (const int orphan : left) {
    if (!is_orphan_of_ours(orphan)) {
      continue;
    }
    if (is_in_session(orphan, pid)) {
      kill(orphan, SIGKILL);
    } else {
      kill(orphan, SIGTERM);
      lingering_.emplace(orphan, Instant::read().steady + kLingering);
    }
  }
}

void PosixRunner::kill_lingering() {
  for (auto entry = lingering_.begin(); entry != lingering_.end();) {
    const bool gone = !is_orphan_of_ours(entry->first);
    if (!gone && Instant::read().steady >= entry->second) {
      for (const int descendant : descendants_of(entry->first)) {
        kill(descendant, SIGKILL);
      }
      kill(entry->first, SIGKILL);
    }
    entry = gone ? lingering_.erase(entry) : std::next(entry);
  }
}

void PosixRunner::close_child(Child& child) {
  for (const int descriptor : {child.terminal, child.pidfd}) {
    if (descriptor >= 0) {
      close(descriptor);
    }
  }
  child.terminal = child.pidfd = -1;
}

ProcessUsage PosixRunner::usage(int pid) {
  ProcessUsage total;
  std::vector<int> all = descendants_of(pid);
  if (const auto found = children_.find(pid); found != children_.end()) {
    found->second.descendants = std::set<int>(all.begin(), all.end());
  }
  all.push_back(pid);
  for (const int one : all) {
    if (const std::optional<ProcessStat> stat = read_process_stat(one)) {
      total.cpu += stat->cpu;
      total.virtual_bytes += stat->virtual_bytes;
      total.resident_bytes += stat->resident_bytes;
    }
  }
  return total;
}

MachineUsage PosixRunner::machine() {
  return read_machine_usage();
}

int PosixRunner::processors() const {
  return static_cast<int>(std::max(1L, sysconf(_SC_NPROCESSORS_ONLN)));
}

}  // namespace luminav::launcher
