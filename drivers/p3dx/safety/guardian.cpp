#include "drivers/p3dx/safety/guardian.hpp"

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
#include <cstdlib>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/arcos/information_packet.hpp"

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

/// Writes all of a frame, with patience for a slow line but not for a dead one.
void write_frame(int line, const std::vector<std::uint8_t>& frame) {
  std::span<const std::uint8_t> rest = frame;
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

/// Hears what the robot says of its wheels.
class WheelListener {
 public:
  /// Takes what the line has, for so long [s]; true when the newest word of the robot is that both wheels stand.
  bool listen(int line, double seconds) {
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
        pause_for(std::max(0.0, end - now_seconds()));  // hung up; the frames are sent all the same
        break;
      }
      parser_.push(std::span(bytes).first(static_cast<std::size_t>(count)));
      while (const auto packet = parser_.next()) {
        if (const auto word =
                is_information(packet->type) ? decode_information(packet->type, packet->payload) : std::nullopt) {
          constexpr int kStandingSpeed = 20;  // [mm/s]
          stands_ = std::abs(word->left_mm_s) <= kStandingSpeed && std::abs(word->right_mm_s) <= kStandingSpeed;
        }
      }
    }
    return stands_;
  }
  void forget() { stands_ = false; }

 private:
  PacketParser parser_;
  bool stands_ = false;
};

void stop_robot(int line, double brake_time) {
  const std::vector<std::vector<std::uint8_t>> halt = {encode_command(ArcosCommand::kStop),
                                                       encode_command(ArcosCommand::kVelocity, 0),
                                                       encode_command(ArcosCommand::kTurnRate, 0)};
  const std::vector<std::vector<std::uint8_t>> leave = {encode_command(ArcosCommand::kEnable, 0),
                                                        encode_command(ArcosCommand::kSonar, 0),
                                                        encode_command(ArcosCommand::kClose)};
  // Said again and again: the driver may have died in the middle of a frame, which swallows what follows it.
  constexpr double kRepeat = 0.03;    // [s]
  constexpr double kOutdated = 0.15;  // [s] a packet and a half: what the robot says before is from before the STOP
  constexpr int kFarewells = 3;
  constexpr double kBetweenFarewells = 0.01;  // [s]
  WheelListener wheels;
  const double begin = now_seconds();
  bool stands = false;
  while (!stands && now_seconds() < begin + brake_time) {
    for (const std::vector<std::uint8_t>& frame : halt) {
      write_frame(line, frame);
    }
    stands = wheels.listen(line, kRepeat);
    if (now_seconds() < begin + kOutdated) {
      wheels.forget();
      stands = false;
    }
  }
  for (int i = 0; i < kFarewells; ++i) {
    if (i > 0) {
      pause_for(kBetweenFarewells);
    }
    for (const std::vector<std::uint8_t>& frame : leave) {
      write_frame(line, frame);
    }
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

[[noreturn]] void guard(int socket, const GuardianParams& params) {
  setsid();  // what is sent to the driver's group is not for it
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT}) {
    signal(signal_number, SIG_IGN);
  }
  prctl(PR_SET_NAME, "p3dx-guardian");
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
      stop_robot(line, params.brake_time);
      let_go();
      continue;
    }
    int descriptor = -1;
    const char message = receive(socket, descriptor);
    last_beat = now_seconds();
    if (message == 0) {
      if (line >= 0) {
        stop_robot(line, params.brake_time);
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

Guardian::Guardian(const GuardianParams& params) {
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
    guard(ends[1], params);
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
