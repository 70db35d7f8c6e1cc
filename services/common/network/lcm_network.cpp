#include "services/common/network/lcm_network.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace luminav {
namespace {

constexpr std::uint16_t kDefaultPort = 7667;
constexpr const char* kDefaultGroup = "239.255.76.67";

/// A whole number that fills the text.
std::optional<int> whole_number(std::string_view text) {
  int number = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stop == end ? std::optional(number) : std::nullopt;
}

/// The value of "...&key=value&..."; LCM takes the last one.
std::optional<int> option(std::string_view options, std::string_view key) {
  std::optional<int> value;
  while (!options.empty()) {
    const std::string_view piece = options.substr(0, options.find('&'));
    options.remove_prefix(std::min(options.size(), piece.size() + 1));
    if (piece.starts_with(key) && piece.substr(key.size()).starts_with('=')) {
      value = whole_number(piece.substr(key.size() + 1));
    }
  }
  return value;
}

bool receives_datagrams_on(int descriptor, std::uint16_t port) {
  int type = 0;
  socklen_t size = sizeof type;
  sockaddr_in bound{};
  socklen_t bound_size = sizeof bound;
  return getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_DGRAM &&
         getsockname(descriptor, reinterpret_cast<sockaddr*>(&bound), &bound_size) == 0 &&
         bound.sin_family == AF_INET && ntohs(bound.sin_port) == port;
}

}  // namespace

std::optional<MulticastAddress> multicast_address(std::string url) {
  if (url.empty()) {
    const char* standard = std::getenv("LCM_DEFAULT_URL");
    url = standard != nullptr && *standard != '\0' ? standard : "udpm://";
  }
  constexpr std::string_view kScheme = "udpm://";
  if (!url.starts_with(kScheme)) {
    return std::nullopt;
  }
  const std::string_view rest = std::string_view(url).substr(kScheme.size());
  const std::size_t question = rest.find('?');
  const std::string_view place = rest.substr(0, question);
  const std::string_view options = question == std::string_view::npos ? "" : rest.substr(question + 1);
  const std::size_t colon = place.rfind(':');
  const std::string group(place.empty() ? kDefaultGroup : place.substr(0, colon));
  const auto port = colon == std::string_view::npos ? kDefaultPort : whole_number(place.substr(colon + 1));
  in_addr address{};
  if (!port || *port <= 0 || *port > 65535 || inet_aton(group.c_str(), &address) == 0) {
    return std::nullopt;
  }
  return MulticastAddress{address.s_addr, static_cast<std::uint16_t>(*port), option(options, "ttl").value_or(0)};
}

std::vector<int> receiving_sockets(const MulticastAddress& address) {
  std::vector<int> sockets;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", failure)) {
    const int descriptor = std::atoi(entry.path().filename().c_str());
    if (receives_datagrams_on(descriptor, address.port)) {
      sockets.push_back(descriptor);
    }
  }
  return sockets;
}

bool join_again(const LcmNetwork& network) {
  const std::optional<MulticastAddress> address = multicast_address(network.url);
  bool joined = false;
  if (address) {
    const ip_mreq membership{{address->group}, {INADDR_ANY}};
    for (const int socket : receiving_sockets(*address)) {
      // first out: a socket has room for twenty memberships only
      setsockopt(socket, IPPROTO_IP, IP_DROP_MEMBERSHIP, &membership, sizeof membership);
      joined = setsockopt(socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership) == 0 || joined;
    }
  }
  return joined;
}

}  // namespace luminav
