#include "services/common/network/network_access.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <cstdlib>

namespace luminav {
namespace {

constexpr std::size_t kMaxPeers = 32;

std::uint32_t read_address(const TomlTable& table, const std::string& text) {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1) {
    table.fail("peers", "must be a list of IPv4 addresses, found \"" + text + "\"");
  }
  return ntohl(address.s_addr);
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// That of $LUMINAV_KEY, else the one that `scripts/launch --make-key` puts into the state folder; "" = there is none.
std::string usual_key_file() {
  if (const std::string named = variable("LUMINAV_KEY"); !named.empty()) {
    return named;
  }
  const std::string state = variable("LUMINAV_STATE");
  const std::filesystem::path folder = state.empty() ? variable("HOME") + "/.local/state/luminav" : state;
  std::error_code unreadable;
  return std::filesystem::exists(folder / "network.key", unreadable) ? (folder / "network.key").string() : "";
}

}  // namespace

NetworkAccess read_network_access(const std::filesystem::path& robot_file) {
  NetworkAccess access;
  std::string key_file;
  if (!robot_file.empty()) {
    const TomlTable table = TomlTable::load(robot_file).table("network");
    const std::vector<std::string> peers = table.texts("peers");
    if (peers.size() > kMaxPeers) {
      table.fail("peers", "must be at most 32 addresses");
    }
    for (const std::string& peer : peers) {
      access.peers.push_back(read_address(table, peer));
    }
    key_file = table.path("key");
    table.reject_unknown();
  }
  key_file = key_file.empty() ? usual_key_file() : key_file;
  if (!key_file.empty()) {
    access.key = read_command_key(key_file);
  }
  return access;
}

std::string describe(const NetworkAccess& access, const std::string& url) {
  const std::optional<MulticastAddress> address = multicast_address(url);
  const std::string key = access.key ? "; commands carry the seal of a key" : "";
  if (!address || address->ttl <= 0) {
    return "network: this machine only" + key;
  }
  if (!access.peers.empty()) {
    return fmt::format("network: this machine and {} peer{}{}", access.peers.size(),
                       access.peers.size() == 1 ? "" : "s",
                       access.key ? key : "; no key, so whoever takes a peer's address is obeyed");
  }
  return access.key ? "network: all machines are heard" + key
                    : "open network: whoever reaches it drives the robot; see docs/security.md";
}

}  // namespace luminav
