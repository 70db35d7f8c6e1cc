#include "drivers/base/safety/guardian.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>

namespace luminav {
namespace {

constexpr char kBeat = 'b';
constexpr char kLine = 'l';
constexpr char kRelease = 'r';

double now_seconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void pause_for(double seconds) {
  poll(nullptr, 0, static_cast<int>(1000.0 * seconds));
}

/// Writes all of it, with patience for a slow line but not for a dead one.
void write_all(int line, std::span<const std::uint8_t> rest) {
  constexpr int kPatience = 100;  // [ms]
  while (!rest.empty()) {
    const ssize_t count = write(line, rest.data(), rest.size());
    if (count > 0) {
      rest = rest.subspan(static_cast<std::size_t>(count));
      continue;
    }
    pollfd writable{line, POLLOUT, 0};
    if ((count < 0 && errno != EAGAIN && errno != EINTR) || poll(&writable, 1, kPatience) <= 0) {
      return;
    }
  }
}

/// Takes what the line has, for so long [s]; true when the newest word of the robot is that both wheels stand.
bool hear_robot(int line, double seconds, const GuardedRobot& robot, bool stands) {
  const double end = now_seconds() + seconds;
  while (now_seconds() < end) {
    const double left = std::max(0.0, end - now_seconds());
    pollfd readable{line, POLLIN, 0};
    if (poll(&readable, 1, static_cast<int>(1000.0 * left) + 1) <= 0) {
      break;
    }
    std::array<std::uint8_t, 1024> bytes;
    const ssize_t count = read(line, bytes.data(), bytes.size());
    if (count <= 0) {
      pause_for(std::max(0.0, end - now_seconds()));  // hung up; the halt is sent all the same
      break;
    }
    stands = robot.hear_wheels(std::span(bytes).first(static_cast<std::size_t>(count))).value_or(stands);
  }
  return stands;
}

void stop_robot(int line, double brake_time, const GuardedRobot& robot) {
  // Said again and again: the driver may have died in the middle of a frame, which swallows what follows it.
  constexpr double kRepeat = 0.03;    // [s]
  constexpr double kOutdated = 0.15;  // [s] a packet and a half: what the robot says before is from before the halt
  constexpr int kFarewells = 3;
  constexpr double kBetweenFarewells = 0.01;  // [s]
  const double begin = now_seconds();
  bool stands = false;
  while (!stands && now_seconds() < begin + brake_time) {
    write_all(line, robot.halt);
    stands = hear_robot(line, kRepeat, robot, stands) && now_seconds() >= begin + kOutdated;
  }
  for (int i = 0; i < kFarewells; ++i) {
    if (i > 0) {
      pause_for(kBetweenFarewells);
    }
    write_all(line, robot.leave);
  }
}

/// The message, with its descriptor if it carries one; 0 when the driver is gone.
char receive(int socket, int& descriptor) {
  char message = 0;
  iovec data{&message, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  msghdr header{};
  header.msg_iov = &data;
  header.msg_iovlen = 1;
  header.msg_control = control.data();
  header.msg_controllen = control.size();
  if (recvmsg(socket, &header, MSG_CMSG_CLOEXEC) <= 0) {
    return 0;
  }
  const cmsghdr* carried = CMSG_FIRSTHDR(&header);
  if (carried != nullptr && carried->cmsg_type == SCM_RIGHTS) {
    std::memcpy(&descriptor, CMSG_DATA(carried), sizeof descriptor);
  }
  return message;
}

[[noreturn]] void guard(int socket, const GuardianParams& params, const GuardedRobot& robot) {
  setsid();  // what is sent to the driver's group is not for it
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT}) {
    signal(signal_number, SIG_IGN);
  }
  prctl(PR_SET_NAME, "base-guardian");
  // Nothing of the driver's may stay open because of it, its standard output neither.
  dup2(socket, STDIN_FILENO);
  socket = STDIN_FILENO;
  close_range(STDOUT_FILENO, STDOUT_FILENO, 0);
  close_range(STDERR_FILENO + 1, ~0U, 0);
  int line = -1;
  double last_beat = now_seconds();
  const auto let_go = [&] {
    if (line >= 0) {
      close(line);
      line = -1;
    }
  };
  while (true) {
    const double left = last_beat + params.silence - now_seconds();
    const int timeout = line < 0 ? -1 : left <= 0.0 ? 0 : static_cast<int>(1000.0 * left) + 1;
    pollfd readable{socket, POLLIN, 0};
    const int count = poll(&readable, 1, timeout);
    if (count < 0) {
      continue;
    }
    if (count == 0) {
      stop_robot(line, params.brake_time, robot);
      let_go();
      continue;
    }
    int descriptor = -1;
    const char message = receive(socket, descriptor);
    last_beat = now_seconds();
    if (message == 0) {
      if (line >= 0) {
        stop_robot(line, params.brake_time, robot);
      }
      _exit(0);
    }
    if (message == kRelease || message == kLine) {
      let_go();
      line = descriptor;
    }
  }
}

}  // namespace

Guardian::Guardian(const GuardianParams& params, const GuardedRobot& robot) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::runtime_error(std::string("guardian: ") + std::strerror(errno));
  }
  child_ = fork();
  if (child_ < 0) {
    throw std::runtime_error(std::string("guardian: ") + std::strerror(errno));
  }
  if (child_ == 0) {
    close(ends[0]);
    guard(ends[1], params, robot);
  }
  close(ends[1]);
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  socket_ = ends[0];
}

Guardian::~Guardian() {
  send(kRelease, -1);
  if (socket_ >= 0) {
    close(socket_);
  }
  if (child_ > 0) {
    waitpid(child_, nullptr, 0);
  }
}

void Guardian::watch_line(int descriptor) {
  send(descriptor >= 0 ? kLine : kRelease, descriptor);
}

void Guardian::beat() {
  send(kBeat, -1);
}

void Guardian::send(char message, int descriptor) {
  if (socket_ < 0) {
    return;
  }
  iovec data{&message, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  msghdr header{};
  header.msg_iov = &data;
  header.msg_iovlen = 1;
  if (descriptor >= 0) {
    header.msg_control = control.data();
    header.msg_controllen = control.size();
    cmsghdr* carried = CMSG_FIRSTHDR(&header);
    carried->cmsg_level = SOL_SOCKET;
    carried->cmsg_type = SCM_RIGHTS;
    carried->cmsg_len = CMSG_LEN(sizeof(int));
    std::memcpy(CMSG_DATA(carried), &descriptor, sizeof descriptor);
  }
  if (sendmsg(socket_, &header, MSG_NOSIGNAL) < 0 && errno != EAGAIN && errno != EINTR) {
    close(socket_);  // the child is gone: the driver says so
    socket_ = -1;
  }
}

}  // namespace luminav
