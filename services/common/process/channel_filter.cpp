#include "services/common/process/channel_filter.hpp"

#include <linux/if_packet.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cstdint>
#include <stdexcept>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

// Offsets from the UDP header: 8 bytes of it, LCM's magic number, its sequence number, the channel with its NUL.
constexpr std::uint32_t kMagicOffset = 8;
constexpr std::uint32_t kChannelOffset = 16;
constexpr std::uint32_t kShortMagic = 0x4c433032;  // "LC02"; fragments have LC03
constexpr std::uint32_t kKeepAll = 0xffffffff;

// What the kernel knows of a packet, outside its bytes.
constexpr auto kFromInterface = static_cast<std::uint32_t>(SKF_AD_OFF + SKF_AD_IFINDEX);
constexpr auto kFromPacketType = static_cast<std::uint32_t>(SKF_AD_OFF + SKF_AD_PKTTYPE);
constexpr auto kFromSource = static_cast<std::uint32_t>(SKF_NET_OFF + 12);  // of the IPv4 header
constexpr std::uint32_t kLoopbackInterface = 1;                             // in every network namespace
constexpr std::uint32_t kPacketLoopback = PACKET_LOOPBACK;

sock_filter load(std::uint32_t offset, std::uint16_t width) {
  return {static_cast<std::uint16_t>(BPF_LD | BPF_ABS | width), 0, 0, offset};
}

/// Skips that many instructions where equal, else goes on.
sock_filter if_equal_skip(std::uint32_t value, std::size_t instructions) {
  return {BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint8_t>(instructions), 0, value};
}

/// Goes on where equal, else skips that many instructions.
sock_filter unless_equal_skip(std::uint32_t value, std::size_t instructions) {
  return {BPF_JMP | BPF_JEQ | BPF_K, 0, static_cast<std::uint8_t>(instructions), value};
}

sock_filter answer(std::uint32_t bytes) {
  return {BPF_RET | BPF_K, 0, 0, bytes};
}

/// Compares the name, with its NUL, four bytes at a time and keeps the message where all of it agrees.
void append_comparison(const std::string& channel, std::vector<sock_filter>& program) {
  struct Piece {
    std::uint32_t offset, value;
    std::uint16_t width;
  };
  std::vector<Piece> pieces;
  const std::size_t size = channel.size() + 1;
  for (std::size_t at = 0; at < size;) {
    const std::size_t count = size - at >= 4 ? 4 : size - at >= 2 ? 2 : 1;
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + count; ++i) {
      value = value << 8 | static_cast<std::uint8_t>(channel.c_str()[i]);
    }
    const auto offset = static_cast<std::uint32_t>(kChannelOffset + at);
    pieces.push_back({offset, value, static_cast<std::uint16_t>(count == 4 ? BPF_W : count == 2 ? BPF_H : BPF_B)});
    at += count;
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    program.push_back(load(pieces[i].offset, pieces[i].width));
    program.push_back(unless_equal_skip(pieces[i].value, 2 * (pieces.size() - i - 1) + 1));
  }
  program.push_back(answer(kKeepAll));
}

/// Drops what comes from others than this machine and the peers; the rest goes on.
void append_senders(const std::vector<std::uint32_t>& peers, std::vector<sock_filter>& program) {
  // An answer is known by the interface lo, or by the copy that the kernel makes of what we send by another one.
  std::vector<sock_filter> tests{load(kFromInterface, BPF_W), if_equal_skip(kLoopbackInterface, 0),
                                 load(kFromPacketType, BPF_W), if_equal_skip(kPacketLoopback, 0)};
  if (!peers.empty()) {
    tests.push_back(load(kFromSource, BPF_W));
  }
  for (const std::uint32_t peer : peers) {
    tests.push_back(if_equal_skip(peer, 0));
  }
  for (std::size_t i = 0; i < tests.size(); ++i) {
    tests[i].jt = BPF_CLASS(tests[i].code) == BPF_JMP ? static_cast<std::uint8_t>(tests.size() - i) : 0;
  }
  program.insert(program.end(), tests.begin(), tests.end());
  program.push_back(answer(0));
}

bool attach(lcm::LCM& lcm, const LcmNetwork& network, const std::vector<sock_filter>& program) {
  const std::optional<MulticastAddress> address = multicast_address(network.url);
  if (!address) {
    return false;
  }
  lcm.getFileno();  // makes the socket, where nothing is subscribed
  std::vector<sock_filter> copy = program;
  const sock_fprog filter{static_cast<unsigned short>(copy.size()), copy.data()};
  bool found = false;
  for (const int socket : receiving_sockets(*address)) {
    found = setsockopt(socket, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) == 0 || found;
  }
  return found;
}

/// Waits until what came before the filter was read; nobody has subscribed yet, so LCM drops it.
void let_pass_what_waits(const LcmNetwork& network) {
  constexpr int kPatience = 200;  // [ms]
  for (int waited = 0; waited < kPatience; ++waited) {
    int waiting = 0;
    for (const int socket : receiving_sockets(*multicast_address(network.url))) {
      int bytes = 0;
      waiting += ioctl(socket, FIONREAD, &bytes) == 0 ? bytes : 0;
    }
    if (waiting == 0) {
      return;
    }
    poll(nullptr, 0, 1);
  }
}

}  // namespace

std::vector<sock_filter> make_socket_filter(const LcmNetwork& network,
                                            const std::optional<std::vector<std::string>>& channels) {
  const std::optional<MulticastAddress> address = multicast_address(network.url);
  std::vector<sock_filter> program;
  if (address && (address->ttl <= 0 || !network.peers.empty())) {
    append_senders(address->ttl <= 0 ? std::vector<std::uint32_t>{} : network.peers, program);
  }
  program.insert(program.end(), {load(kMagicOffset, BPF_W), if_equal_skip(kShortMagic, 1), answer(0)});
  if (!channels) {
    program.push_back(answer(kKeepAll));
    return program;
  }
  for (const std::string& channel : *channels) {
    append_comparison(channel, program);
  }
  program.push_back(answer(0));
  return program;
}

void receive_from_peers_only(lcm::LCM& lcm, const LcmNetwork& network) {
  if (!multicast_address(network.url)) {
    return;
  }
  if (!attach(lcm, network, make_socket_filter(network, std::nullopt))) {
    throw std::runtime_error("the socket of " + network.url + " cannot be shut against strangers");
  }
  let_pass_what_waits(network);
}

bool receive_only(lcm::LCM& lcm, const LcmNetwork& network, std::vector<std::string> channels) {
  channels.emplace_back(channels::kNodeStatus);
  return attach(lcm, network, make_socket_filter(network, channels));
}

}  // namespace luminav
