#include "drivers/p3dx/arcos/arcos_packet.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace luminav {
namespace {

constexpr std::uint8_t kHeader1 = 0xFA;
constexpr std::uint8_t kHeader2 = 0xFB;
constexpr std::size_t kSmallestCount = 3;  // type and checksum

}  // namespace

std::uint16_t arcos_checksum(std::span<const std::uint8_t> bytes) {
  // High and low bytes are summed apart, four of each at a time in 16-bit lanes: 252 bytes cannot overflow a lane, and
  // a line full of false headers costs a checksum per two bytes.
  constexpr std::uint64_t kLanes = 0x00FF00FF00FF00FFULL;
  std::uint32_t high = 0;
  std::uint32_t low = 0;
  std::size_t i = 0;
  const std::size_t pairs_end = bytes.size() & ~std::size_t{1};
  while (i + 8 <= pairs_end) {
    std::uint64_t first = 0;
    std::uint64_t second = 0;
    const std::size_t stop = std::min(pairs_end, i + 1024);
    for (; i + 8 <= stop; i += 8) {
      std::uint64_t word;
      std::memcpy(&word, &bytes[i], 8);
      first += word & kLanes;
      second += (word >> 8) & kLanes;
    }
    constexpr bool kLittle = std::endian::native == std::endian::little;
    for (int lane = 0; lane < 64; lane += 16) {
      (kLittle ? high : low) += static_cast<std::uint32_t>(first >> lane) & 0xFFFFU;
      (kLittle ? low : high) += static_cast<std::uint32_t>(second >> lane) & 0xFFFFU;
    }
  }
  for (; i < pairs_end; i += 2) {
    high += bytes[i];
    low += bytes[i + 1];
  }
  auto sum = static_cast<std::uint16_t>((high << 8) + low);
  if (bytes.size() % 2 != 0) {
    sum = static_cast<std::uint16_t>(sum ^ bytes.back());
  }
  return sum;
}

std::vector<std::uint8_t> encode_packet(std::uint8_t type, std::span<const std::uint8_t> payload) {
  payload = payload.first(std::min(payload.size(), kLargestPayload));
  std::vector<std::uint8_t> frame;
  frame.reserve(payload.size() + 6);
  frame.assign({kHeader1, kHeader2, static_cast<std::uint8_t>(payload.size() + kSmallestCount), type});
  frame.insert(frame.end(), payload.begin(), payload.end());
  const std::uint16_t sum = arcos_checksum(std::span(frame).subspan(3));
  frame.push_back(static_cast<std::uint8_t>(sum >> 8));
  frame.push_back(static_cast<std::uint8_t>(sum & 0xFF));
  return frame;
}

void PacketParser::push(std::span<const std::uint8_t> bytes, std::int64_t utime, double byte_time) {
  if (bytes.empty()) {
    return;
  }
  // What is used up goes before the buffer would grow, so its size stays near the largest chunk.
  base_ += begin_;
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  while (!chunks_.empty() && chunks_.front().end <= base_) {
    chunks_.pop_front();
  }
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  chunks_.push_back({base_ + buffer_.size(), utime, byte_time});
}

std::optional<PacketView> PacketParser::next() {
  while (begin_ < buffer_.size()) {
    const std::uint8_t* start = buffer_.data() + begin_;
    const std::size_t left = buffer_.size() - begin_;
    const void* header = std::memchr(start, kHeader1, left);
    if (header == nullptr) {
      begin_ += left;
      return std::nullopt;
    }
    begin_ += static_cast<std::size_t>(static_cast<const std::uint8_t*>(header) - start);
    const std::span<const std::uint8_t> rest(buffer_.data() + begin_, buffer_.size() - begin_);
    if (rest.size() < 2) {
      return std::nullopt;
    }
    if (rest[1] != kHeader2) {
      ++begin_;  // FA FA FB: the second FA may be the header
      continue;
    }
    if (rest.size() < 3) {
      return std::nullopt;
    }
    const std::size_t count = rest[2];
    if (count < kSmallestCount) {
      ++bad_packets_;
      ++begin_;
      continue;
    }
    if (rest.size() < count + 3) {
      return std::nullopt;
    }
    const auto sum = static_cast<std::uint16_t>((rest[count + 1] << 8) | rest[count + 2]);
    if (arcos_checksum(rest.subspan(3, count - 2)) != sum) {
      ++bad_packets_;
      ++begin_;
      continue;
    }
    PacketView packet{rest[3], rest.subspan(4, count - kSmallestCount), arrival(base_ + begin_)};
    begin_ += count + 3;
    return packet;
  }
  return std::nullopt;
}

void PacketParser::give_up_partial() {
  if (has_partial()) {
    ++bad_packets_;
    ++begin_;
  }
}

void PacketParser::clear() {
  base_ += buffer_.size();
  buffer_.clear();
  begin_ = 0;
  chunks_.clear();
}

std::int64_t PacketParser::arrival(std::uint64_t offset) const {
  // Chunks are few: one per read since the oldest unused byte.
  const auto chunk = std::find_if(chunks_.begin(), chunks_.end(), [&](const Chunk& c) { return offset < c.end; });
  if (chunk == chunks_.end()) {
    return 0;
  }
  return chunk->utime - static_cast<std::int64_t>(static_cast<double>(chunk->end - offset) * chunk->byte_time);
}

}  // namespace luminav
