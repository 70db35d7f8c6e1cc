#include "tests/system/faults/interference.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "tests/system/faults/hosts/network_host.hpp"

namespace luminav {
namespace {

constexpr int kViewerPort = 18080;

bool run(const std::string& command) {
  return std::system((command + " 2>/dev/null").c_str()) == 0;
}

void end(pid_t process) {
  if (process > 0) {
    kill(process, SIGKILL);
    waitpid(process, nullptr, 0);
  }
}

int connect_to_viewer() {
  const int client = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(kViewerPort);
  if (connect(client, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0) {
    return client;
  }
  close(client);
  return -1;
}

}  // namespace

PacketLoss::PacketLoss(int port, int percent) {
  if (!run(
          fmt::format("nft 'add table ip luminav_loss; add chain ip luminav_loss in {{ type filter hook input priority "
                      "0; }}; add rule ip luminav_loss in udp dport {} numgen random mod 100 < {} drop'",
                      port, percent))) {
    throw std::runtime_error("nft loses no packets here");
  }
}

PacketLoss::~PacketLoss() {
  run("nft delete table ip luminav_loss");
}

bool PacketLoss::is_possible() {
  return has_own_network() && run("nft list tables >/dev/null");
}

BusyLoops::BusyLoops(int per_core) {
  const long count = per_core * sysconf(_SC_NPROCESSORS_ONLN);
  for (long i = 0; i < count; ++i) {
    const pid_t process = fork();
    if (process == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      volatile unsigned counter = 0;
      while (true) {
        const unsigned next = counter + 1;
        counter = next;
      }
    }
    processes_.push_back(process);
  }
}

BusyLoops::~BusyLoops() {
  for (const pid_t process : processes_) {
    end(process);
  }
}

// A second view of the folder lies over the first: that one has files open for writing and could not be made read-only.
ReadOnlyFolder::ReadOnlyFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
  if (mount(folder_.c_str(), folder_.c_str(), nullptr, MS_BIND, nullptr) != 0) {
    throw std::runtime_error(fmt::format("{}: cannot be mounted read-only", folder_.string()));
  }
  if (mount(nullptr, folder_.c_str(), nullptr, MS_BIND | MS_REMOUNT | MS_RDONLY, nullptr) != 0) {
    umount2(folder_.c_str(), MNT_DETACH);
    throw std::runtime_error(fmt::format("{}: cannot be mounted read-only", folder_.string()));
  }
}

ReadOnlyFolder::~ReadOnlyFolder() {
  umount2(folder_.c_str(), MNT_DETACH);
}

DoomedViewer::DoomedViewer(const std::vector<std::string>& command) {
  std::vector<std::string> words = command;
  words.insert(words.end(), {"--port", std::to_string(kViewerPort)});
  process_ = fork();
  if (process_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int nowhere = open("/dev/null", O_RDWR);
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
      dup2(nowhere, descriptor);
    }
    std::vector<char*> arguments;
    for (std::string& word : words) {
      arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    execv(arguments.front(), arguments.data());
    _exit(127);
  }
  for (int i = 0; i < 100; ++i) {
    if (const int client = connect_to_viewer(); client >= 0) {
      close(client);
      return;
    }
    poll(nullptr, 0, 100);
  }
  kill_it();
  throw std::runtime_error("the viewer does not serve");
}

bool DoomedViewer::stop_robot() const {
  const int client = connect_to_viewer();
  const std::string body = R"({"engaged":true})";
  const std::string request =
      fmt::format("POST /api/stop HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: {}\r\n\r\n{}", body.size(), body);
  std::array<char, 64> answer{};
  pollfd readable{client, POLLIN, 0};
  constexpr int kPatience = 1000;  // [ms]
  const bool is_answered = client >= 0 && send(client, request.data(), request.size(), MSG_NOSIGNAL) > 0 &&
                           poll(&readable, 1, kPatience) > 0 && recv(client, answer.data(), answer.size() - 1, 0) > 0;
  close(client);
  return is_answered && std::string(answer.data()).find(" 200 ") != std::string::npos;
}

void DoomedViewer::kill_it() {
  end(process_);
  process_ = -1;
}

pid_t child_of(pid_t process) {
  std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", process));
  pid_t child = 0;
  children >> child;
  return child;
}

}  // namespace luminav
