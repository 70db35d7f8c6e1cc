#include <algorithm>
#include <cstdlib>

#include "drivers/p3dx/arcos/arcos_packet.hpp"

using namespace luminav;

namespace {

void require(bool claim) {
  if (!claim) {
    std::abort();
  }
}

/// What a parser finds in a stream that comes in pieces of this size.
std::vector<std::vector<std::uint8_t>> find_packets(std::span<const std::uint8_t> stream, std::size_t piece) {
  PacketParser parser;
  std::vector<std::vector<std::uint8_t>> frames;
  for (std::size_t i = 0; i < stream.size(); i += piece) {
    parser.push(stream.subspan(i, std::min(piece, stream.size() - i)), static_cast<std::int64_t>(i), 1041.7);
    while (const auto packet = parser.next()) {
      frames.push_back(encode_packet(packet->type, packet->payload));
    }
  }
  for (int i = 0; i < 300 && parser.has_partial(); ++i) {
    parser.give_up_partial();
    while (parser.next()) {
    }
  }
  require(!parser.has_partial());
  return frames;
}

}  // namespace

/// Whatever comes, in whatever pieces: the same packets, and each of them is in the stream byte for byte.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span stream(data, size);
  const auto whole = find_packets(stream, std::max<std::size_t>(size, 1));
  require(whole == find_packets(stream, 1));
  require(whole == find_packets(stream, 7));
  auto at = stream.begin();
  for (const auto& frame : whole) {
    at = std::search(at, stream.end(), frame.begin(), frame.end());
    require(at != stream.end());
    at += static_cast<std::ptrdiff_t>(frame.size());
  }
  return 0;
}
