#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace luminav {

/// An LCM network, and who is heard on it.
struct LcmNetwork {
  LcmNetwork(std::string network_url, std::vector<std::uint32_t> other_machines = {})  // NOLINT: a URL is a network
      : url(std::move(network_url)), peers(std::move(other_machines)) {}
  LcmNetwork(const char* network_url) : url(network_url) {}  // NOLINT

  std::string url;                   // "udpm://GROUP:PORT?ttl=N", "memq://", or "" for LCM's own default
  std::vector<std::uint32_t> peers;  // IPv4 addresses in the host's byte order; with ttl above 0, none = everybody
};

/// Where a udpm network is.
struct MulticastAddress {
  std::uint32_t group = 0;  // IPv4, network byte order
  std::uint16_t port = 0;
  int ttl = 0;
};

/// As LCM 1.3.1 reads the URL; nothing for other providers than udpm and for what it does not take.
[[nodiscard]] std::optional<MulticastAddress> multicast_address(std::string url);

/// The receiving sockets of this process on a network's port, also those of a second handle on the same port.
/// LCM does not tell its sockets.
[[nodiscard]] std::vector<int> receiving_sockets(const MulticastAddress& address);

/// Joins the group anew on all receiving sockets, by the interface that the route names now. An interface that went and
/// came again has forgotten the group, and LCM never asks again. False when no socket could join.
bool join_again(const LcmNetwork& network);

}  // namespace luminav
