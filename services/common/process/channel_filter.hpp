#pragma once

#include <linux/filter.h>

#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <string>
#include <vector>

#include "services/common/network/lcm_network.hpp"

namespace luminav {

/// A socket filter (classic BPF, data begins with the UDP header) for one network: keeps LCM's short messages from
/// those who may speak, and of them those on the channels, if any are named (an empty list keeps none). Where the URL's
/// ttl is 0 only this machine may speak, else the network's peers beside it, or everybody where none are named. LCM's
/// long messages are dropped: none of ours needs fragments, and LCM 1.3.1 puts them together wrongly.
[[nodiscard]] std::vector<sock_filter> make_socket_filter(const LcmNetwork& network,
                                                          const std::optional<std::vector<std::string>>& channels);

/// Lets the kernel drop what strangers send, before it wakes LCM's receiving thread. open_lcm does this for every
/// handle: LCM's ttl limits sending only, its sockets hear all interfaces. Throws std::runtime_error where a udpm
/// network's socket cannot be shut.
void receive_from_peers_only(lcm::LCM& lcm, const LcmNetwork& network);

/// Lets the kernel drop, beside strangers' messages, what comes on other channels than these and NODE_STATUS, by which
/// a process hears itself: every process gets all that is said on the network, and most of it is for others. To be
/// called once all is subscribed, and again when that is other channels. Returns whether a socket was found to filter.
bool receive_only(lcm::LCM& lcm, const LcmNetwork& network, std::vector<std::string> channels);

}  // namespace luminav
