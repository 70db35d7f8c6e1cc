#include "services/viewer/address/page_addresses.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <qrencode.h>

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

std::string qr_code(const std::string& text) {
  const std::unique_ptr<QRcode, decltype(&QRcode_free)> code(
      QRcode_encodeString(text.c_str(), 0, QR_ECLEVEL_L, QR_MODE_8, 1), QRcode_free);
  if (code == nullptr) {
    return "";
  }
  constexpr int kMargin = 2;  // [modules] half of what the standard asks for; phones read it
  const auto is_black = [&](int column, int row) {
    const bool is_inside = column >= 0 && row >= 0 && column < code->width && row < code->width;
    return is_inside && (code->data[row * code->width + column] & 1) != 0;
  };
  std::string lines;
  for (int row = -kMargin; row < code->width + kMargin; row += 2) {
    lines += "\033[30;107m";
    for (int column = -kMargin; column < code->width + kMargin; ++column) {
      const bool upper = is_black(column, row);
      const bool lower = is_black(column, row + 1);
      lines += upper && lower ? "█" : upper ? "▀" : lower ? "▄" : " ";
    }
    lines += "\033[0m\n";
  }
  return lines;
}

}  // namespace luminav
