#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "drivers/base/line/byte_stream.hpp"

namespace luminav {
namespace {

/// A socket on its way to the peer; name resolution of a numeric address or localhost does not wait.
int start_to_connect(const std::string& host, int port) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int status = getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (status != 0) {
    throw std::runtime_error("host " + host + ": " + gai_strerror(status));
  }
  int descriptor = -1;
  int error = 0;
  // IPv4 first: simulators listen there, and "localhost" often resolves to ::1 first.
  for (const int family : {AF_INET, AF_INET6}) {
    for (const addrinfo* a = found; a != nullptr && descriptor < 0; a = a->ai_next) {
      if (a->ai_family != family) {
        continue;
      }
      descriptor = socket(family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
      if (descriptor >= 0 && connect(descriptor, a->ai_addr, a->ai_addrlen) != 0 && errno != EINPROGRESS) {
        error = errno;
        close(descriptor);
        descriptor = -1;
      }
    }
  }
  freeaddrinfo(found);
  if (descriptor < 0) {
    throw std::runtime_error("tcp:" + host + ":" + std::to_string(port) + ": " + std::strerror(error));
  }
  return descriptor;
}

}  // namespace

TcpStream::TcpStream(const std::string& host, int port)
    : DescriptorStream(start_to_connect(host, port)), peer_("tcp:" + host + ":" + std::to_string(port)) {
  const int on = 1;
  setsockopt(descriptor(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

bool TcpStream::check_connected() {
  if (connected_ || !is_open()) {
    return connected_ && is_open();
  }
  pollfd waiting{descriptor(), POLLOUT, 0};
  if (poll(&waiting, 1, 0) <= 0) {
    return false;
  }
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(descriptor(), SOL_SOCKET, SO_ERROR, &error, &size);
  if (error != 0) {
    fail(peer_ + ": " + std::strerror(error) +
         (error == ECONNREFUSED ? " (is the robot or the simulator running?)" : ""));
    return false;
  }
  connected_ = true;
  return true;
}

std::size_t TcpStream::read(std::span<std::uint8_t> bytes) {
  return check_connected() ? DescriptorStream::read(bytes) : 0;
}

std::size_t TcpStream::write(std::span<const std::uint8_t> bytes) {
  return check_connected() ? DescriptorStream::write(bytes) : 0;
}

void TcpStream::close() {
  if (is_open()) {
    // A process that holds a copy of the descriptor would otherwise keep the connection alive.
    shutdown(descriptor(), SHUT_RDWR);
  }
  DescriptorStream::close();
}

}  // namespace luminav
