#include "services/launcher/deputy/processes/orphan_guard.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <set>
#include <stdexcept>

namespace luminav::launcher {
namespace {

struct Note {
  int process_group;
  int add;  // else forget
};

void pause_milliseconds(long milliseconds) {
  timespec duration{milliseconds / 1000, (milliseconds % 1000) * 1'000'000};
  nanosleep(&duration, nullptr);
}

void end_groups(const std::set<int>& groups) {
  for (const int group : groups) {
    kill(-group, SIGTERM);
  }
  constexpr int kPatience = 60;  // x 50 ms: a driver brings its robot to a stop first
  for (int i = 0; i < kPatience; ++i) {
    bool any_left = false;
    for (const int group : groups) {
      any_left = any_left || kill(-group, 0) == 0;
    }
    if (!any_left) {
      return;
    }
    pause_milliseconds(50);
  }
  for (const int group : groups) {
    kill(-group, SIGKILL);
  }
}

[[noreturn]] void run_guard(int pipe) {
  setsid();
  prctl(PR_SET_NAME, "deputy-guard");
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    signal(signal_number, SIG_IGN);
  }
  // Nobody who reads the deputy's output shall wait for the guard as well.
  dup2(pipe, 3);
  const int nowhere = open("/dev/null", O_RDWR);
  for (int descriptor = 0; descriptor < 3; ++descriptor) {
    dup2(nowhere, descriptor);
  }
  close_range(4, ~0U, 0);
  std::set<int> groups;
  Note note{};
  while (true) {
    const ssize_t count = read(3, &note, sizeof note);
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count != static_cast<ssize_t>(sizeof note)) {
      break;
    }
    if (note.add != 0) {
      groups.insert(note.process_group);
    } else {
      groups.erase(note.process_group);
    }
  }
  end_groups(groups);
  _exit(0);
}

}  // namespace

OrphanGuard::OrphanGuard() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    throw std::runtime_error("cannot make a pipe for the guard of the child processes");
  }
  pid_ = fork();
  if (pid_ < 0) {
    close(ends[0]);
    close(ends[1]);
    throw std::runtime_error("cannot start the guard of the child processes");
  }
  if (pid_ == 0) {
    close(ends[1]);
    run_guard(ends[0]);
  }
  close(ends[0]);
  pipe_ = ends[1];
  // A guard that was killed must not take the deputy with it.
  signal(SIGPIPE, SIG_IGN);
}

OrphanGuard::~OrphanGuard() {
  close(pipe_);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void OrphanGuard::send(int process_group, bool add) {
  const Note note{process_group, add ? 1 : 0};
  [[maybe_unused]] const ssize_t written = write(pipe_, &note, sizeof note);
}

void OrphanGuard::watch(int process_group) {
  send(process_group, true);
}

void OrphanGuard::forget(int process_group) {
  send(process_group, false);
}

}  // namespace luminav::launcher
