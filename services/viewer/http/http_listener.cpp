#include "services/viewer/http/http_listener.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "services/common/process/clock.hpp"
#include "services/viewer/http/http_rules.hpp"

namespace luminav {
namespace {

constexpr int kBacklog = 1024;
constexpr int kSendBuffer = 128 * 1024;  // [bytes] what a dead client can hold back
constexpr int kLook = 100;               // [ms] between looks at the time
constexpr int kAcceptedAtOnce = 64;

std::int64_t steady_now() {
  return read_clock(CLOCK_MONOTONIC);
}

struct AddressList {
  addrinfo* first = nullptr;
  ~AddressList() {
    if (first != nullptr) {
      freeaddrinfo(first);
    }
  }
};

int bind_to(const addrinfo& address) {
  const int socket = ::socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket < 0) {
    return -1;
  }
  // Without SO_REUSEPORT: two viewers would share one port and each get half of the requests.
  const int yes = 1;
  const int no = 0;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof kSendBuffer);
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  if (address.ai_family == AF_INET6) {
    setsockopt(socket, IPPROTO_IPV6, IPV6_V6ONLY, &no, sizeof no);
  }
  if (bind(socket, address.ai_addr, address.ai_addrlen) != 0 || listen(socket, kBacklog) != 0) {
    close(socket);
    return -1;
  }
  return socket;
}

int listening_socket(const std::string& name, int port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  AddressList addresses;
  int socket = -1;
  if (getaddrinfo(name.c_str(), std::to_string(port).c_str(), &hints, &addresses.first) == 0) {
    for (const addrinfo* address = addresses.first; address != nullptr && socket < 0; address = address->ai_next) {
      socket = bind_to(*address);
    }
  }
  if (socket < 0) {
    throw std::runtime_error(
        fmt::format("cannot listen on {} port {}: another viewer has it, or this machine lacks the address; see --port",
                    name, port));
  }
  return socket;
}

int port_of(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                                             : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

/// Of the machine, as text. One machine has as many IPv6 addresses as it likes below its network: they count as one.
std::string machine_of(const sockaddr_storage& peer) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (peer.ss_family == AF_INET) {
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in&>(peer).sin_addr, text.data(), text.size());
    return text.data();
  }
  in6_addr address = reinterpret_cast<const sockaddr_in6&>(peer).sin6_addr;
  if (IN6_IS_ADDR_V4MAPPED(&address)) {
    inet_ntop(AF_INET, &address.s6_addr[12], text.data(), text.size());
    return text.data();
  }
  if (!IN6_IS_ADDR_LOOPBACK(&address)) {
    std::fill(&address.s6_addr[8], &address.s6_addr[16], std::uint8_t{0});
  }
  inet_ntop(AF_INET6, &address, text.data(), text.size());
  return text.data();
}

}  // namespace

HttpListener::HttpListener(const HttpListenerParams& params)
    : params_(params),
      socket_(listening_socket(params.listen, params.port)),
      port_(port_of(socket_)),
      wakeup_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

HttpListener::~HttpListener() {
  is_ending_ = true;
  wake();
  if (thread_.joinable()) {
    thread_.join();
  }
  close(socket_);
  close(wakeup_);
}

void HttpListener::start(Answer answer) {
  answer_ = std::move(answer);
  thread_ = std::thread([this] { run(); });
}

void HttpListener::wake() {
  has_news_ = true;
  eventfd_write(wakeup_, 1);
}

void HttpListener::run() {
  std::int64_t last_look = 0;
  while (!is_ending_) {
    wait();
    const std::int64_t now = steady_now();
    if (has_news_.exchange(false) || now - last_look > 1000 * kLook) {
      last_look = now;
      for (HttpConnection& connection : connections_) {
        connection.go_on(now);
        connection.check_time(now);
      }
    }
    std::erase_if(connections_, [](const HttpConnection& connection) { return connection.socket() < 0; });
  }
  connections_.clear();
}

void HttpListener::wait() {
  std::vector<pollfd> descriptors = {{wakeup_, POLLIN, 0}, {socket_, POLLIN, 0}};
  for (const HttpConnection& connection : connections_) {
    const int events = (connection.wants_to_receive() ? POLLIN : 0) | (connection.wants_to_send() ? POLLOUT : 0);
    descriptors.push_back({connection.socket(), static_cast<short>(events), 0});
  }
  poll(descriptors.data(), descriptors.size(), connections_.empty() ? -1 : kLook);
  const std::int64_t now = steady_now();
  eventfd_t count = 0;
  eventfd_read(wakeup_, &count);
  std::size_t i = 2;
  for (HttpConnection& connection : connections_) {
    const short happened = descriptors[i++].revents;
    if ((happened & POLLOUT) != 0) {
      connection.send();
      if (connection.has_end()) {
        connection.go_on(now);
      }
    }
    if (connection.socket() >= 0 && (happened & (POLLIN | POLLERR | POLLHUP)) != 0) {
      connection.receive(now);
    }
    if (happened != 0) {
      answer_all(connection, now);
    }
  }
  if (descriptors[1].revents != 0) {
    accept_all(now);
  }
}

void HttpListener::accept_all(std::int64_t now) {
  for (int i = 0; i < kAcceptedAtOnce; ++i) {
    sockaddr_storage peer{};
    socklen_t size = sizeof peer;
    const int client = accept4(socket_, reinterpret_cast<sockaddr*>(&peer), &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (client < 0) {
      if (errno == EMFILE || errno == ENFILE) {
        [[maybe_unused]] const bool made = make_room("");
      }
      return;
    }
    const std::string address = machine_of(peer);
    if (!make_room(address)) {
      close(client);
      continue;
    }
    HttpConnection& connection = connections_.emplace_back(client, address, now);
    connection.receive(now);  // most requests come with the connection
    answer_all(connection, now);
  }
}

// The one that waited longest goes: a person's request is complete within milliseconds.
bool HttpListener::make_room(const std::string& address) {
  std::size_t of_all = 0;
  std::size_t of_address = 0;
  HttpConnection* oldest = nullptr;
  HttpConnection* oldest_of_address = nullptr;
  for (HttpConnection& connection : connections_) {
    if (connection.socket() < 0) {
      continue;
    }
    const bool is_of_address = connection.address() == address;
    ++of_all;
    of_address += is_of_address ? 1 : 0;
    if (connection.is_endless()) {
      continue;
    }
    if (oldest == nullptr || connection.since() < oldest->since()) {
      oldest = &connection;
    }
    if (is_of_address && (oldest_of_address == nullptr || connection.since() < oldest_of_address->since())) {
      oldest_of_address = &connection;
    }
  }
  HttpConnection* gives_way = nullptr;
  if (of_address >= params_.connections_per_address) {
    gives_way = oldest_of_address;
  } else if (of_all >= params_.connections || address.empty()) {
    gives_way = oldest;
  } else {
    return true;
  }
  if (gives_way == nullptr) {
    return false;
  }
  gives_way->close();
  return true;
}

void HttpListener::answer_all(HttpConnection& connection, std::int64_t now) {
  try {
    while (const std::optional<HttpRequest> request = connection.take_request()) {
      HttpResponse response = answer(*request);
      if (response.more && !may_be_endless(connection.address())) {
        const HttpError error(503, "as many pages are open already as can be served");
        connection.refuse(error, params_.headers, now);
        return;
      }
      connection.answer(*request, std::move(response), params_.headers, now);
      connection.go_on(now);
    }
  } catch (const HttpError& error) {
    connection.refuse(error, params_.headers, now);
  }
}

HttpResponse HttpListener::answer(const HttpRequest& request) const {
  try {
    return answer_(request);
  } catch (const std::exception&) {
    throw HttpError(500, "the viewer failed at this request");
  }
}

bool HttpListener::may_be_endless(const std::string& address) const {
  std::size_t of_all = 0;
  std::size_t of_address = 0;
  for (const HttpConnection& connection : connections_) {
    if (connection.is_endless()) {
      ++of_all;
      of_address += connection.address() == address ? 1 : 0;
    }
  }
  return of_all < params_.endless && (is_loopback(address) || of_address < params_.endless_per_address);
}

}  // namespace luminav
