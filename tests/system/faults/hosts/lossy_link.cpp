#include "tests/system/faults/hosts/lossy_link.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>

#include "services/launcher/instant.hpp"

namespace luminav {
namespace {

constexpr const char* kGroup = "239.255.76.67";

sockaddr_in address_of(const char* host, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, host, &address.sin_addr);
  return address;
}

int open_receiver(int port) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int yes = 1;
  const int buffer = 4 << 20;
  setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof(buffer));
  const sockaddr_in address = address_of("0.0.0.0", port);
  ip_mreq membership{};
  inet_pton(AF_INET, kGroup, &membership.imr_multiaddr);
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      setsockopt(descriptor, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof(membership)) != 0) {
    throw std::runtime_error(fmt::format("cannot listen to {}:{}", kGroup, port));
  }
  return descriptor;
}

int open_sender(int port, int& own_port) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const unsigned char ttl = 0;
  setsockopt(descriptor, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof(ttl));
  const sockaddr_in any = address_of("0.0.0.0", 0);
  const sockaddr_in group = address_of(kGroup, port);
  sockaddr_in own{};
  socklen_t size = sizeof(own);
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&any), sizeof(any)) != 0 ||
      connect(descriptor, reinterpret_cast<const sockaddr*>(&group), sizeof(group)) != 0 ||
      getsockname(descriptor, reinterpret_cast<sockaddr*>(&own), &size) != 0) {
    throw std::runtime_error(fmt::format("cannot send to {}:{}", kGroup, port));
  }
  own_port = ntohs(own.sin_port);
  return descriptor;
}

}  // namespace

LossyLink::LossyLink(int one_port, int other_port, const LossyLinkParams& params, std::set<std::string> local)
    : params_(params), local_(std::move(local)), random_(params.seed) {
  sides_[0].port = one_port;
  sides_[1].port = other_port;
  for (Side& side : sides_) {
    side.receiver = open_receiver(side.port);
    side.sender = open_sender(side.port, side.sender_port);
  }
  thread_ = std::thread([this] { run(); });
}

LossyLink::~LossyLink() {
  ending_ = true;
  thread_.join();
  for (const Side& side : sides_) {
    close(side.receiver);
    close(side.sender);
  }
}

void LossyLink::run() {
  while (!ending_) {
    const std::int64_t now = launcher::Instant::read().steady;
    std::int64_t due = now + 50'000;
    for (const Waiting& message : waiting_) {
      due = std::min(due, message.due);
    }
    pollfd descriptors[2] = {{sides_[0].receiver, POLLIN, 0}, {sides_[1].receiver, POLLIN, 0}};
    ::poll(descriptors, 2, static_cast<int>(std::max<std::int64_t>(0, (due - now + 999) / 1000)));
    for (int side = 0; side < 2; ++side) {
      if (descriptors[side].revents != 0) {
        take(side);
      }
    }
    send_due(launcher::Instant::read().steady);
  }
}

bool LossyLink::stays(const std::vector<char>& datagram) const {
  constexpr std::size_t kHeader = 8;  // magic and number, then the channel's name with a zero
  if (datagram.size() <= kHeader) {
    return true;
  }
  const auto end = std::find(datagram.begin() + kHeader, datagram.end(), '\0');
  return local_.contains(std::string(datagram.begin() + kHeader, end));
}

void LossyLink::take(int side) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<char> bytes(65'536);
  for (;;) {
    sockaddr_in from{};
    socklen_t size = sizeof(from);
    bytes.resize(65'536);
    const ssize_t count =
        recvfrom(sides_[side].receiver, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (count < 0) {
      return;
    }
    bytes.resize(static_cast<std::size_t>(count));
    if (ntohs(from.sin_port) == sides_[side].sender_port || stays(bytes)) {
      continue;
    }
    if (uniform(random_) < params_.loss) {
      ++lost_;
      continue;
    }
    const int copies = uniform(random_) < params_.duplicate ? 2 : 1;
    for (int copy = 0; copy < copies; ++copy) {
      const double delay = params_.delay + params_.jitter * uniform(random_);
      waiting_.push_back({launcher::Instant::read().steady + static_cast<std::int64_t>(delay * 1e6), 1 - side, bytes});
    }
    ++forwarded_;
  }
}

void LossyLink::send_due(std::int64_t now) {
  std::stable_sort(waiting_.begin(), waiting_.end(), [](const Waiting& a, const Waiting& b) { return a.due < b.due; });
  std::size_t sent = 0;
  for (; sent < waiting_.size() && waiting_[sent].due <= now; ++sent) {
    const Waiting& message = waiting_[sent];
    [[maybe_unused]] const ssize_t written =
        send(sides_[message.side].sender, message.bytes.data(), message.bytes.size(), 0);
  }
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(sent));
}

}  // namespace luminav
