#include "services/common/process/channel_filter.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "services/common/process/channels.hpp"

namespace luminav {
namespace {

// Offsets from the UDP header: 8 bytes of it, LCM's magic number, its sequence number, the channel with its NUL.
constexpr std::uint32_t kMagicOffset = 8;
constexpr std::uint32_t kChannelOffset = 16;
constexpr std::uint32_t kShortMagic = 0x4c433032;  // "LC02"; fragments have another
constexpr std::uint32_t kKeepAll = 0xffffffff;
constexpr std::uint16_t kDefaultPort = 7667;

sock_filter load(std::uint32_t offset, std::uint16_t width) {
  return {static_cast<std::uint16_t>(BPF_LD | BPF_ABS | width), 0, 0, offset};
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

/// "udpm://GROUP:PORT?..."; an empty URL is LCM's default.
std::optional<std::uint16_t> port_of(std::string url) {
  if (url.empty()) {
    const char* standard = std::getenv("LCM_DEFAULT_URL");
    url = standard != nullptr ? standard : "";
  }
  if (url.empty()) {
    return kDefaultPort;
  }
  const std::string address = url.substr(0, url.find('?'));
  const std::size_t colon = address.rfind(':');
  std::uint16_t port = 0;
  const char* end = address.data() + address.size();
  if (!address.starts_with("udpm://") || colon <= 4 ||
      std::from_chars(address.data() + colon + 1, end, port).ptr != end) {
    return std::nullopt;
  }
  return port;
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

std::vector<sock_filter> make_channel_filter(const std::vector<std::string>& channels) {
  std::vector<sock_filter> program{
      load(kMagicOffset, BPF_W), unless_equal_skip(kShortMagic, 1), {BPF_JMP | BPF_JA, 0, 0, 1}, answer(kKeepAll)};
  for (const std::string& channel : channels) {
    append_comparison(channel, program);
  }
  program.push_back(answer(0));
  return program;
}

bool receive_only(lcm::LCM& lcm, const std::string& url, const std::vector<std::string>& channels) {
  const std::optional<std::uint16_t> port = port_of(url);
  if (!port) {
    return false;
  }
  lcm.getFileno();  // makes the socket, where nothing is subscribed
  std::vector<std::string> wanted = channels;
  wanted.emplace_back(channels::kNodeStatus);  // each process hears which files the others were given
  std::vector<sock_filter> program = make_channel_filter(wanted);
  const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  bool found = false;
  // LCM does not tell its socket; it is the one that is bound to the network's port.
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", failure)) {
    const int descriptor = std::atoi(entry.path().filename().c_str());
    if (receives_datagrams_on(descriptor, *port)) {
      found = setsockopt(descriptor, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) == 0 || found;
    }
  }
  return found;
}

}  // namespace luminav
