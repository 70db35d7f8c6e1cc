#include "tests/system/faults/hosts/network_host.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace luminav {

NetworkHost::NetworkHost() {
  int ready[2];
  if (pipe2(ready, O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe");
  }
  holder_ = fork();
  if (holder_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const char answer = unshare(CLONE_NEWNET) == 0 ? 'y' : 'n';
    [[maybe_unused]] const ssize_t written = write(ready[1], &answer, 1);
    close(ready[0]);
    close(ready[1]);
    for (;;) {
      pause();
    }
  }
  close(ready[1]);
  char answer = 'n';
  const bool heard = holder_ > 0 && read(ready[0], &answer, 1) == 1;
  close(ready[0]);
  if (heard && answer == 'y') {
    descriptor_ = open(fmt::format("/proc/{}/ns/net", holder_).c_str(), O_RDONLY | O_CLOEXEC);
  }
  if (descriptor_ < 0) {
    if (holder_ > 0) {
      kill(holder_, SIGKILL);
      waitpid(holder_, nullptr, 0);
    }
    throw std::runtime_error("this kernel allows no network namespaces");
  }
  run("ip link set lo up");
}

NetworkHost::~NetworkHost() {
  close(descriptor_);
  kill(holder_, SIGKILL);
  waitpid(holder_, nullptr, 0);
}

void NetworkHost::run(const std::string& command) const {
  const InsideHost inside(this);
  if (std::system(command.c_str()) != 0) {
    throw std::runtime_error(fmt::format("failed: {}", command));
  }
}

InsideHost::InsideHost(const NetworkHost* host) {
  if (host == nullptr) {
    return;
  }
  previous_ = open(fmt::format("/proc/self/task/{}/ns/net", gettid()).c_str(), O_RDONLY | O_CLOEXEC);
  if (previous_ < 0 || setns(host->descriptor(), CLONE_NEWNET) != 0) {
    throw std::runtime_error("cannot enter a network namespace");
  }
}

InsideHost::~InsideHost() {
  if (previous_ >= 0) {
    setns(previous_, CLONE_NEWNET);
    close(previous_);
  }
}

Cable::Cable(const NetworkHost& one, const NetworkHost& other) {
  // Snooping would ask for memberships first and lose the first messages.
  middle_.run("ip link add bridge type bridge mcast_snooping 0 && ip link set bridge up");
  int number = 0;
  for (const NetworkHost* host : {&one, &other}) {
    ++number;
    middle_.run(
        fmt::format("ip link add port{0} type veth peer name net0 netns {1} && ip link set port{0} master bridge "
                    "&& ip link set port{0} up",
                    number, host->holder()));
    host->run(fmt::format(
        "ip addr add 10.77.0.{}/24 dev net0 && ip link set net0 up && ip route add 224.0.0.0/4 dev net0", number));
  }
}

void Cable::cut() {
  middle_.run("ip link set port1 down; ip link set port2 down");
}

void Cable::join() {
  middle_.run("ip link set port1 up && ip link set port2 up");
}

std::int64_t Cable::sent_by(const NetworkHost& host) {
  const InsideHost inside(&host);
  std::ifstream table("/proc/thread-self/net/dev");
  for (std::string line; std::getline(table, line);) {
    const std::size_t name = line.find("net0:");
    if (name != std::string::npos) {
      std::istringstream fields(line.substr(name + 5));
      std::int64_t value = 0;
      constexpr int kSentBytes = 9;  // the ninth column
      for (int i = 0; i < kSentBytes && fields >> value; ++i) {
      }
      return value;
    }
  }
  return 0;
}

bool has_own_network() {
  struct stat own {};
  struct stat machine {};
  return stat("/proc/self/ns/net", &own) == 0 &&
         (stat("/proc/1/ns/net", &machine) != 0 || own.st_ino != machine.st_ino);
}

Neighbour::Neighbour() {
  const std::string own = fmt::format(
      "ip link add net0 type veth peer name net0 netns {} && ip addr add {}/24 dev net0 && ip link set net0 up && "
      "ip route replace 224.0.0.0/4 dev net0",
      host_.holder(), kOwnAddress);
  if (std::system(own.c_str()) != 0) {
    throw std::runtime_error("no wire to a second host");
  }
  host_.run("ip addr add 10.77.0.2/24 dev net0 && ip link set net0 up && ip route add 224.0.0.0/4 dev net0");
}

}  // namespace luminav
