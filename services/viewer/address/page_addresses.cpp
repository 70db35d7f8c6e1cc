#include "services/viewer/address/page_addresses.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <array>
#include <memory>

namespace luminav {

std::vector<std::string> reachable_addresses(const std::string& listen) {
  if (listen != "0.0.0.0") {
    return {listen};
  }
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) {
    return {};
  }
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> cards(first, freeifaddrs);
  std::vector<std::string> addresses;
  for (const ifaddrs* card = first; card != nullptr; card = card->ifa_next) {
    const bool is_usable = (card->ifa_flags & IFF_UP) != 0 && (card->ifa_flags & IFF_LOOPBACK) == 0;
    if (!is_usable || card->ifa_addr == nullptr || card->ifa_addr->sa_family != AF_INET) {
      continue;
    }
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto* address = reinterpret_cast<const sockaddr_in*>(card->ifa_addr);
    if (inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size()) != nullptr) {
      addresses.emplace_back(text.data());
    }
  }
  return addresses;
}

}  // namespace luminav
